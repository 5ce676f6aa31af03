"""Pure: what a receiver that tells its raw measurements measures, and how well."""

from wayline.strict import Strict
from wayline_simulator.gps_model import NotNegative, Positive


class RawModel(Strict, frozen=True, kw_only=True):
    """`[raw]`: pseudoranges and Dopplers of the receiver of `[gps]`.

    Orbits, clocks and air err as that model's positions wander (`position_wander_std_m` and
    `_time_s`, of each satellite apart), Dopplers by its `velocity_std_mps`. Stds are one sigma at
    45 dB-Hz; what is 6 dB weaker is twice as noisy.
    """

    code_std_m: NotNegative = 0.5
    """Thermal noise of the code loop; u-blox M8 claims 0.3 to 0.6 m at such strengths."""
    clock_drift_std_mps: NotNegative = 100.0
    """Of the crystal's frequency at the start: 0.3 ppm, a compensated one (TCXO)."""
    clock_drift_walk_mps: NotNegative = 0.05
    """How the drift walks in a second; the receiver warms up. A judgement."""
    clock_walk_m: NotNegative = 0.1
    """How the offset walks in a second, besides: white frequency noise of 2e-19 (h0)."""
    clock_resets: bool = True
    """The clock is set by a millisecond where it is half of one off, as cheap receivers do."""
    system_offset_std_m: NotNegative = 30.0
    """Of each further system's clock to the first one's; smartloc's GLONASS: tens of metres."""
    least_dbhz: Positive = 20.0
    """What is weaker is not tracked; u-blox M8's tracking threshold, less what it loses."""
    echo_street_m: Positive = 15.0
    echo_canyon_m: Positive = 35.0
    """Mean detour of a signal that comes only by way of a wall: the width of such streets once or
    twice; at smartloc's truth a quarter of the residuals are beyond 25 m."""
    echo_doppler_std_mps: NotNegative = 0.3
    """What the wall adds to the range rate. A judgement: along a street nearly nothing."""
    mixed_street_m: NotNegative = 1.0
    mixed_canyon_m: NotNegative = 3.0
    """Std of what walls add to a signal that also comes straight. Judgements."""
    mixed_time_s: Positive = 4.0
