"""One folder for each question that a campaign can be judged by."""
