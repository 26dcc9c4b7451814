"""What a part promises to the testbed, tried out: ``testbed check method tangent:avoid`` says in words what a stranger's file breaks."""
