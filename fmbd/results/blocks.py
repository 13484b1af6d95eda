"""Growing HDF5 datasets that stay readable: a kill or a full disk costs at most the block being written."""

import errno
import os
from collections.abc import Sequence

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

# Widely readable: "latest" opens neither in VTK nor in older tools.
LIBVER = ("earliest", "v110")

CHUNK_ROWS = 64
SCALAR_CHUNK_ROWS = 512
CHUNK_VALUES = 2**17

# Disk space claimed ahead [bytes]: for HDF5's own tables and for the last words of a run on a full disk.
HEADROOM = 2**18
DISK_FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)


def create_growing(
    group: h5py.Group, name: str, columns: tuple[int, ...] = (), dtype: DTypeLike = np.float64
) -> h5py.Dataset:
    """Create an empty dataset of shape (0, *columns) that grows along its first axis."""
    width = max(1, int(np.prod(columns)))
    rows = max(1, min(CHUNK_ROWS, CHUNK_VALUES // width)) if columns else SCALAR_CHUNK_ROWS
    return group.create_dataset(
        name,
        shape=(0, *columns),
        maxshape=(None, *(max(1, n) for n in columns)),
        chunks=(rows, *(max(1, n) for n in columns)),
        dtype=dtype,
        fillvalue=np.nan if np.issubdtype(np.dtype(dtype), np.floating) else 0,
    )


def append(rows: Sequence[tuple[h5py.Dataset, NDArray[np.generic]]]) -> None:
    """Append a block of rows to each dataset, all of one file, and flush.

    Raises OSError, before anything is changed, when the disk cannot hold the blocks.
    """
    file = rows[0][0].file
    reserve(file, sum(_growth(dataset, len(block)) for dataset, block in rows))
    for dataset, block in rows:
        start = len(dataset)
        dataset.resize(start + len(block), axis=0)
        dataset[start:] = block
    file.flush()
    # HDF5 cuts the file to its own size when it flushes, so the headroom is claimed anew.
    reserve(file, 0)


def reserve(file: h5py.File, nbytes: int) -> None:
    """Claim disk space behind the end of the file, where the platform can.

    HDF5 cannot take back half a flush: on a full disk it leaves tables that point behind the end of the
    file, which then never opens again. So the space is claimed before HDF5 writes, or OSError is raised.
    """
    if not hasattr(os, "posix_fallocate"):
        return
    try:
        os.posix_fallocate(file.id.get_vfd_handle(), file.id.get_filesize(), nbytes + HEADROOM)
    except OSError as error:
        if error.errno in DISK_FULL:
            raise


def trim(file: h5py.File) -> None:
    """Give back the space that was claimed and not used."""
    file.flush()
    if hasattr(os, "posix_fallocate"):
        os.ftruncate(file.id.get_vfd_handle(), file.id.get_filesize())


def _growth(dataset: h5py.Dataset, rows: int) -> int:
    """Return an upper bound of the bytes that `rows` more rows take: whole chunks and their index."""
    chunk = dataset.chunks
    new_chunks = rows // chunk[0] + 1
    index_entry = 4 * (16 + 8 * len(chunk))
    return new_chunks * (int(np.prod(chunk)) * dataset.dtype.itemsize + index_entry)
