"""Pictures painted in layers, each the inside of a shape given by distances, with smooth edges."""

import numpy as np


class Picture:
    def __init__(self, size, low, high, color):
        """size: rows and columns of pixels; low, high: corners (x, y) of the picture, lower left and upper right, in the
        units of the shapes. An upside-down picture has high y below low y. color: sRGB from 0 to 255, of the ground."""
        rows, columns = size
        x = low[0] + (high[0] - low[0]) * (np.arange(columns) + 0.5) / columns
        y = high[1] + (low[1] - high[1]) * (np.arange(rows) + 0.5) / rows
        self.y, self.x = np.meshgrid(y, x, indexing="ij")
        self.pixel = abs(high[1] - low[1]) / rows
        self.image = np.empty((rows, columns, 3))
        self.image[:] = color

    def lay(self, distance, color, strength=1.0):
        """Paints where the distances are negative, one per pixel."""
        share = strength * np.clip(0.5 - distance / (1.4 * self.pixel), 0, 1)[..., None]
        self.image += share * (np.asarray(color, float) - self.image)

    def indexed(self):
        """(indices, palette) for files.png_bytes: the 256 commonest colours, and the nearest of them for the others."""
        colors, inverse, count = np.unique(4 * np.round(self.image / 4).reshape(-1, 3).clip(0, 63 * 4), axis=0,
                                           return_inverse=True, return_counts=True)
        palette = colors[np.sort(np.argsort(-count, kind="stable")[:256])]
        nearest = np.argmin(np.sum((colors[:, None] - palette[None])**2, axis=2), axis=1)
        return nearest[inverse.reshape(-1)].reshape(self.image.shape[:2]).astype(np.uint8), palette.astype(np.uint8)
