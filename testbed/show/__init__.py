"""What people look at: recordings of single flights and the page of a whole campaign."""
