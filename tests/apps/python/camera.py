"""The camera that the README's quickstart leaves to its reader: it slides to the right in a box with a ball."""
import numpy as np

FRAMES, STEP = 8, 0.03  # metres to the right per frame


def depth_image(left):
    """Millimetres, 240 x 320: a box of 4 x 3 m with a wall 2.5 m ahead, and a ball, from (left, 0, 0)."""
    x, y = np.meshgrid((np.arange(320) - 159.5) / 160, (np.arange(240) - 119.5) / 160)
    depth = np.minimum(2.5, np.minimum((np.copysign(2, x) - left) / x, 1.5 / np.abs(y)))
    centre = np.array([0.3 - left, 0.2, 1.8])
    a, b = x * x + y * y + 1, x * centre[0] + y * centre[1] + centre[2]
    root = b * b - a * (centre @ centre - 0.4**2)
    depth = np.where(root > 0, (b - np.sqrt(np.maximum(root, 0))) / a, depth)
    return np.rint(1000 * depth).astype(np.uint16)


def frames():
    for i in range(FRAMES):
        yield i / 30, depth_image(STEP * i)
