"""Runs: what configurations ask for, their outputs, checkpoints, and going on.

`model` is what readers of configurations make (`vcm.read`, `config.read`); `runner.Run` is a run of
one in its folder.
"""
