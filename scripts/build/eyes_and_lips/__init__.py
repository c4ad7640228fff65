# SPDX-License-Identifier: GPL-3.0-or-later
"""Trains regressors of lids, irises and lips on drawn people; ../../train_eyes_and_lips runs it."""
