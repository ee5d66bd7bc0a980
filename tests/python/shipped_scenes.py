"""Runs data/scenes.py into the folder that standard input names."""

import runpy
import sys
from pathlib import Path

script = Path(__file__).parents[2] / "data" / "scenes.py"
sys.argv = [str(script), sys.stdin.read()]
runpy.run_path(str(script), run_name="__main__")
