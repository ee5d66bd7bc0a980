"""Says what OpenEXR's own library finds in the file whose name comes on standard input."""

import json
import sys

import numpy
import OpenEXR

with OpenEXR.File(sys.stdin.read().strip(), separate_channels=True) as file:
    part = file.parts[0]
    header = part.header
    numbers = {}
    texts = {}
    for name, value in header.items():
        if isinstance(value, str):
            texts[name] = value
        elif isinstance(value, (float, int)) and not isinstance(value, bool):
            numbers[name] = float(value)
        elif isinstance(value, numpy.ndarray) and value.size == 1:
            numbers[name] = float(value[0])  # how the binding gives a double
        elif isinstance(value, tuple) and name == "chromaticities":
            numbers.update({f"{name}.{i}": float(v) for i, v in enumerate(value)})
    channels = {}
    for name, channel in part.channels.items():
        assert channel.pixels.dtype == numpy.float32, (name, channel.pixels.dtype)
        assert (channel.xSampling, channel.ySampling) == (1, 1), name
        assert not channel.pLinear, name
        channels[name] = [float(v) for v in channel.pixels.ravel()]
    print(
        json.dumps(
            {
                "parts": len(file.parts),
                "width": part.width(),
                "height": part.height(),
                "zip16": part.compression() == OpenEXR.ZIP_COMPRESSION,
                "scan_lines": part.type() == OpenEXR.scanlineimage,
                "increasing": header["lineOrder"] == OpenEXR.INCREASING_Y,
                "channels": channels,
                "texts": texts,
                "numbers": numbers,
            }
        )
    )
