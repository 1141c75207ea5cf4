"""Deep reflectance fields (thesis chapter 7): corpus, networks, losses and scores."""
