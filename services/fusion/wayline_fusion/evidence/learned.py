"""Pure: what has been learned of the sensors beside the filter's states."""

import msgspec

from wayline.noise_scale import NoiseScale
from wayline_fusion.evidence.bias_wander import BiasWander


class Learned(msgspec.Struct, frozen=True):
    """Good for as long as the sensors are the same; a vehicle that is lost keeps it."""

    position_noise: NoiseScale = NoiseScale()
    """Of the white part of a receiver's positions."""
    claim_factor: float = 1.0
    """How much more than claimed fixes are off the way that gyro and wheels have reckoned, as a
    factor of the std; 1 while courses are told."""
    doppler_noise: NoiseScale = NoiseScale()
    """Of a receiver's speeds and courses."""
    wander: BiasWander = BiasWander()
    """Of the gyro's bias."""
