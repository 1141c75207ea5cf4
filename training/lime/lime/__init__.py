"""Live intrinsic material estimation (thesis chapter 6): corpus, networks, losses and scores."""
