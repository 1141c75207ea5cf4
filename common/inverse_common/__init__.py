# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the programs in Python share: inverse-play, inverse-transcode and the scripts of pipelines/."""
