"""An animation as GIF, which browsers show in a page. Each picture states its time and phase."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from stepover.motion.motion import Motion
from stepover.output import write_whole

RATE = 12.5
"""Pictures per second. A GIF counts in hundredths of a second."""
BEFORE, AFTER = 0.4, 0.6
"""Time shown before lift-off of leg 1 and after touch-down of leg 2 [s]."""
COLOURS, SAMPLES, INK = 256, 5, (40, 40, 40)
PHASES = ("walking", "phase 1: leg 1 over", "phase 2: both feet down", "phase 3: leg 2 over")


def crossing_times(motion: Motion, rate: float = RATE) -> np.ndarray:
    """Times of the pictures (K,) [s]: from just before lift-off of leg 1 to just after touch-down of leg 2."""
    start, end = motion.time[motion.samples(1).start] - BEFORE, motion.time[motion.samples(3).stop] + AFTER
    return np.arange(start, end, 1.0 / rate)


def save_gif(motion: Motion, pictures: Sequence[np.ndarray], times: np.ndarray, path: str | Path, name: str) -> Path:
    """Write pictures as an endless GIF in real time. The same pictures give the same bytes.

    Args:
        motion: the motion in the pictures; gives the phases.
        pictures: K arrays (height, width, 3) of uint8.
        times: (K,) uniform times of the pictures [s].
        path: the folder.
        name: file name without ".gif".

    Raises:
        InvalidInput: the folder does not exist or cannot be written to.
    """
    labelled = [_labelled(picture, time, motion) for picture, time in zip(pictures, times, strict=True)]
    palette = _palette(labelled)  # one for all: what stands still is equal in all pictures and is stored once
    frames = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in labelled]
    file = io.BytesIO()
    period = round(1e3 * float(times[1] - times[0]))
    frames[0].save(file, "GIF", save_all=True, append_images=frames[1:], duration=period, loop=0, optimize=False)
    target = Path(path) / f"{name}.gif"
    write_whole(target, lambda whole: whole.write(file.getvalue()))
    return target


def _palette(images: Sequence[Image.Image]) -> Image.Image:
    """The colours of pictures, taken from SAMPLES of them."""
    chosen = [np.asarray(images[k]) for k in np.linspace(0, len(images) - 1, SAMPLES).astype(int)]
    return Image.fromarray(np.concatenate(chosen)).quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=1)


def _labelled(picture: np.ndarray, time: float, motion: Motion) -> Image.Image:
    """A picture with its time and phase in the upper right corner."""
    image = Image.fromarray(picture)
    size = max(8, image.height // 24)
    phase = int(motion.phase[np.searchsorted(motion.time, time - 1e-9)])
    text, corner = f"{time:.2f} s\n{PHASES[phase]}", (image.width - size, 0.8 * size)
    ImageDraw.Draw(image).text(corner, text, fill=INK, font=ImageFont.load_default(size), anchor="ra", align="right")
    return image
