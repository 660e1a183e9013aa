"""Heights of the grounds."""

import numpy as np

SLOPE = np.radians(10)
BEND = 3.0  # radius of the bends at both ends of the slope (m)


def ramp_rise(z):
    """Height of ramp.glb up to its second bend (m)."""
    low = BEND * np.sin(SLOPE)
    z = np.maximum(z, 0)
    return np.where(z < low, BEND - np.sqrt(BEND**2 - np.minimum(z, low)**2), BEND * (1 - np.cos(SLOPE)) + (z - low) * np.tan(SLOPE))


def shore_rise(x):
    """Height of shore.glb (m): bumps of 4.5 cm, none where |x| < 0.3."""
    fade = np.clip((np.abs(x) - 0.3) / 0.4, 0, 1)
    rise = 0.015 * np.sin(2 * np.pi * x / 1.4) + 0.010 * np.sin(2 * np.pi * x / 0.854 + 1)
    return fade**2 * (3 - 2 * fade) * rise
