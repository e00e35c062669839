"""How the thresholds were found, in five sentences, with the numbers that the code has."""

from harness.tuning.scoring.alarms import GAP
from harness.tuning.scoring.clearance import HORIZON
from harness.tuning.scoring.estimate import FEWEST_EPISODES, LEVEL, RESAMPLES
from harness.tuning.scoring.imu_events import ROUGH

WORLDS = (
    "Every robot drives in the same worlds, which come in pairs of one kind and different seeds: a "
    "threshold is chosen on one half and scored on the other, the unseen seeds."
)
TRUTH = (
    f"The truth is the simulator's: contacts with hazards, where those at most {GAP:g} s apart are one "
    f"event, and the ground's RMS roughness over 0.3 m, rough from {ROUGH * 1e3:g} mm."
)
ALARMS = (
    "An alarm is a run of scans below the threshold; it is right if it overlaps a contact or ends at "
    f"most {GAP:g} s before one, as a clearance warning is if a contact follows within {HORIZON:g} s."
)
CHOICE = (
    "Chosen is what maximises event F1 for contacts and balanced accuracy for the ground and for steps; "
    "the safe clearance is a sum of measured lengths, which the contacts only check."
)
INTERVALS = (
    f"Intervals are {100 * LEVEL:g} % percentiles of {RESAMPLES} resamples of whole episodes within "
    "their strata (the rescaled bootstrap of Rao and Wu, 1988), the same resamples for both values of a "
    f"gain; with fewer than {FEWEST_EPISODES} episodes that have what is counted there is none."
)
SENTENCES = (WORLDS, TRUTH, ALARMS, CHOICE, INTERVALS)
