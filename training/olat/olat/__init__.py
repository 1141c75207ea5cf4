# SPDX-License-Identifier: LGPL-2.1-or-later
"""Deep reflectance fields (thesis chapter 7): corpus, networks, losses and scores."""
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2]))  # what all trainings share
