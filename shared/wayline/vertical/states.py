"""Pure: what altitude and slope are estimated with."""


class VerticalStates:
    """Places in the state vector, with the unit of each; plain numbers are fast to index by."""

    ALTITUDE = 0  # m above mean sea level
    SLOPE = 1  # tan of the slope angle, positive uphill in the direction of travel
    BARO_BIAS = 2  # m, barometric altitude minus altitude
    CURVATURE = 3  # change of the slope for a metre of travel
    TORQUE_BIAS = 4  # of the slope by torque: wind, accessories, air
    INVERSE_MASS = 5  # stated mass over the true one; the engine's gain is in it too
    OWN_BIAS = 6  # of the slope that the vehicle itself reports
    SPEED_ERROR = 7  # m/s, of the wheels at the end of the last window of torque
    SPEED_ERROR_BEFORE = 8  # at its begin
    GPS_ERROR = 9  # slow error of the first receiver's altitude, in its own stds; then the next's
