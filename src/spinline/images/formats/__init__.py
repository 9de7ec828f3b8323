"""Files of frames, one format a file: a module here with a `FORMAT` is found by itself, and knows nothing of the others.

A format says which files are its own (suffixes, and the first bytes for files named otherwise) and opens one as a
`FrameReader`: frames (frame, row, column), a few at a time, with an `Account` of what the file holds. Formats from elsewhere
are added by `register`. What a reader must do is told by the contract suite in ``tests/frame_readers.py``, which every format
inherits.

===========  ==============================================================================
`hdf5`       HDF5: datasets, links, virtual datasets, Eiger masters, NXtomo, netCDF-4 packing
`netcdf3`    classic netCDF
`npz`        arrays of an .npz by name
`npy`        one array
`tiff`       TIFF, all pages of one shape
`fabio`      EDF, CBF, IMG, SPE, MRC, ... by the package fabio (optional)
`picture`    PNG and other grey pictures by the package imageio (optional)
===========  ==============================================================================
"""

from spinline.images.formats.base import Account, FrameFormat, FrameReader, formats, open_file, register

__all__ = ["Account", "FrameFormat", "FrameReader", "formats", "open_file", "register"]
