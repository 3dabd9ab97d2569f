"""The numbers by which `simulate(error=...)` searches and verifies, in one place.

They stand between price and promise. Both are measured on random regular scenes
(tests/models/regular_scenes.py): seeds 200 to 599 served to choose the numbers, seeds 1000 to 1199
judge them. `docs/generators/tuning.py` halves and doubles each number and tells what becomes of
both, for all strategies and for second runs alone; docs/background/accuracy_cost.md has its tables.
Those that change nothing there serve scenes that are stiff, chaotic or at the limit of doubles, and
ends that are met early; `make campaign OF=errors` draws such scenes, and judges the promise.
"""

from __future__ import annotations

# Where trials and second runs aim: factors of the error asked for, or of another run's scale. -----
FIRST_BY_DEFECT, FIRST = 0.5, 3.0
"""The multiples of the error asked for at which the first trial aims: if its defect is to be known,
after which most runs need no other trial, and if not."""
AT_FEW_TIMES, IF_DAMPED = 4.0, 100.0
"""Both are multiplied by these where few times are kept, as the error is hardly largest there, and
where dampers make the motion forget its errors."""
FEW = 50
"""At fewer times than these, the error of a run may be small by chance."""
AIM = 0.65
"""Later trials aim at this multiple of the error asked for."""
LEAST_CHANGE, FARTHER = 1.5, 100.0
"""Factors by which the next trial is tighter: at least, and after a failed or chaotic one."""
BETTER, BETTER_SERIES, SPARED = 25.0, 100.0, 1.6
"""The least factors by which a second run is tighter than its trial. BETTER_SERIES is for `taylor`,
to which a digit more costs little, and whose order changes with the tolerance. SPARED is a further
factor that most second runs are tighter by, which lets them verify slightly tighter trials too."""
BETTER_STILL = 8.0
"""One more second run is tighter than all others by this factor."""
FOR_BOTH = 5.0
"""A method is chosen for an error smaller by this factor, as second runs take the same method."""

# When something counts as known: bounds of distances and ratios. ---------------------------------
LIKELY = 0.9
"""A trial no farther from a second run than this share of the error is likely good enough."""
NOTHING_IN_COMMON = 0.2
"""Beyond this distance of two runs, the error is known only to be large."""
RATIO, SPARE = 5.0, 0.35
"""Two second runs whose scales differ by less than RATIO may be off alike, and by how much another
method than the trial's is better is not known: then SPARE is added."""
ALIKE, SHARE_IF_ALIKE = 20.0, 1.0
"""A trial whose rtol is less than ALIKE times the tightest may share errors with second runs as
tight as doubles allow: an implicit step's remainder, or that of steps which stability limits. Then
at least SHARE_IF_ALIKE times the distance is added."""
CAUTION_IF_TIGHT = 0.5
"""The exponent by which the error of looser runs is scaled down to that of these second runs."""
UNSTABLE = 5.0
"""A run that is lost with a larger error than this is not chaotic; its correction is unstable."""
EXPENSIVE = 18.0
"""Where a series takes as long as more right-hand sides, it is expensive."""
COMPENSATED_BELOW = 1e-12
"""The rtol below which trials use compensated sums of the state."""

# What a refusal blames: they change no run. -------------------------------------------------------
HOPELESS = 1e-6
"""A larger error at the tightest tolerances is not rounding alone, but its growth."""
LATE, LARGE_ANGLE = 0.1, 100.0
"""A late start is to blame where the rounding of times makes the share LATE of the error; angles
above LARGE_ANGLE, rad, unless without them the error would be hopeless too."""

# The budget. --------------------------------------------------------------------------------------
MOST_RUNS, MOST_SEARCHES = 16, 3
"""The number of runs after which a search ends, and of searches for the least error."""
MOST_STEPS, FIRST_COUNTS_AS = 300, 100
"""A later run may take MOST_STEPS times as many steps as the first trial, which counts as
FIRST_COUNTS_AS if it took fewer."""
