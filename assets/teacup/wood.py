"""Oiled oak planks as an indexed picture: rings cut lengthwise, fibres, pores and a few small knots. Repeats both ways."""

import numpy as np

TILE = (7.2, 9.6)          # metres of table that the picture covers: across the planks, along the grain
SIZE = (2048, 1536)        # pixels: across, along
PLANKS = 6
LEVELS, TINTS = 32, 8      # shades of one plank, hues of planks


def soft_noise(rng, across, along):
    """Periodic noise of unit variance with the given correlation lengths in pixels (H across by W along)."""
    white = rng.random(SIZE) - 0.5
    fa, fl = np.fft.fftfreq(SIZE[0])[:, None], np.fft.rfftfreq(SIZE[1])[None]
    keep = np.exp(-2 * np.pi**2 * ((fa * across)**2 + (fl * along)**2))
    noise = np.fft.irfft2(np.fft.rfft2(white) * keep, SIZE)
    return noise / noise.std()


def make():
    """(indices SIZE uint8, palette): rows run across the planks, columns along the grain."""
    rng = np.random.Generator(np.random.PCG64(20120714))
    across = (np.arange(SIZE[0]) + 0.5) / SIZE[0] * TILE[0]
    along = (np.arange(SIZE[1]) + 0.5) / SIZE[1] * TILE[1]
    width = TILE[0] / PLANKS
    plank = np.minimum((across / width).astype(int), PLANKS - 1)
    y = (across - plank * width)[:, None] - width / 2
    turns = 2 * np.pi * along[None] / TILE[1]

    wobble = 0.020 * soft_noise(rng, 80, 130) + 0.006 * soft_noise(rng, 18, 100)
    shade, tint = np.zeros(SIZE), np.zeros(SIZE[0])
    for k in range(PLANKS):
        rows = plank == k
        a = rng.random(12)
        # Distance to the heart of the tree, which runs slightly askew under the plank: cathedrals where it is near.
        heart = (a[0] - 0.5) * 0.9 + 0.05 * np.sin(turns + 6.3 * a[1])
        depth = 0.15 + 0.32 * a[2] + 0.12 * np.sin(turns + 6.3 * a[3]) + 0.022 * np.sin(2 * turns + 6.3 * a[4])
        yy = y[rows] + wobble[rows]
        radius = np.hypot(yy - heart, depth)
        for _ in range(int(a[5] > 0.35) + int(a[6] > 0.75)):  # knots: the rings flow around them
            b = rng.random(4)
            ky, kx, size = (b[0] - 0.5) * 0.7 * width, b[1] * TILE[1], 0.040 + 0.035 * b[2]
            dx = (along[None] - kx + TILE[1] / 2) % TILE[1] - TILE[1] / 2
            d = np.hypot((yy - ky) / size, dx / (1.6 * size))
            radius = radius + 1.3 * size * np.exp(-0.12 * d**2) * np.tanh((yy - ky) / size) * np.sign(ky - heart)
            grain = 0.5 + 0.5 * np.cos(2 * np.pi * d / 0.34)
            shade[rows] += (0.42 + 0.14 * grain) * np.exp(-(d / 0.85)**6) + 0.25 * np.exp(-(d / 1.5)**2)
        ring = radius / (0.050 + 0.018 * a[7]) + a[8]
        phase = ring - np.floor(ring)
        shade[rows] += 0.46 * phase**2.2 * np.clip((1 - phase) / 0.10, 0, 1)  # late wood darkens, then stops sharply
        tint[rows] = a[9]
        shade[rows] += 0.26 * (a[10] - 0.5)
    shade += 0.085 * soft_noise(rng, 1.1, 38) + 0.05 * soft_noise(rng, 4.0, 90) + 0.05 * soft_noise(rng, 55, 210)
    pores = soft_noise(rng, 0.7, 7.0)
    shade += 0.16 * np.clip(pores - 1.5, 0, 1.2)
    edge = np.abs(np.abs(y) - width / 2)  # the joint between planks
    shade += 0.9 * np.exp(-(edge / 0.0055)**2) + 0.12 * np.exp(-(edge / 0.02)**2)
    level = np.clip(np.round((0.10 + 0.80 * shade) * (LEVELS - 1)), 0, LEVELS - 1).astype(np.uint8)
    hue = np.minimum((tint * TINTS).astype(int), TINTS - 1).astype(np.uint8)
    indices = hue[:, None] * LEVELS + level

    light, middle, dark = np.array([214, 166, 112.]), np.array([164, 108, 62.]), np.array([62, 34, 18.])
    ramp = np.linspace(0, 1, LEVELS)[:, None]
    colours = np.where(ramp < 0.55, light + (middle - light) * ramp / 0.55, middle + (dark - middle) * (ramp - 0.55) / 0.45)
    palette = []
    for t in np.linspace(-1, 1, TINTS):
        palette.append(colours * (1 + 0.09 * t * np.array([1.15, 1.0, 0.9])))
    return indices, np.clip(np.round(np.concatenate(palette)), 0, 255).astype(np.uint8)
