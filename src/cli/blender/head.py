"""Adds sweeplight to Blender's render engines.

Blender evaluates the scene frame by frame, with drivers, constraints, modifiers and simulations, as it does for any engine.
This file writes what it finds into one glTF file, lets one sweeplight process render it, and hands each frame back as it
comes, as linear light: exposure and view transform stay Blender's. Coordinates in the file are Blender's own beneath a root
node that turns z up into y up. What glTF has no word for (widths of lamps, emitters that nobody sees, camera shift) stands
in `extras`, as `sweeplight help scenes` tells.
"""

import atexit
import json
import math
import os
import queue
import re
import shutil
import struct
import subprocess
import tempfile
import threading
import time
import traceback
import zlib
from hashlib import blake2b

import bpy
import numpy as np
from bpy.app.handlers import persistent

bl_info = {
    "name": "sweeplight",
    "description": "Radiosity animations that recompute only what the movers changed",
    "blender": (4, 2, 0),
    "version": (1, 0, 0),
    "category": "Render",
}

# The program that wrote this file.
BINARY = ""

# Seconds between two looks at the process.
PATIENCE = 0.05

# Numbers closer than this, in metres or shares, count as equal: a driver's rounding moves nothing.
STILL = 1e-6

# Most numbers that the shapes of one deforming object may take: 1 GB of memory.
MOST_MORPHED = 1 << 28

# Edges of the polygon that stands for a disk.
DISK_EDGES = 32


class Trouble(Exception):
    """What ends a render: told to the user as it stands."""


class Cancelled(Exception):
    """The user has had enough."""
