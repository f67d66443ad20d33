# SPDX-License-Identifier: Apache-2.0
"""Small volumes in every format, for volume_file_fuzzer to begin with. The first byte of each says which of the fuzzer's
names the rest gets (half of it, rounded down), and which end is read."""

import base64
import gzip
import struct
import zlib

NRRD, NHDR, NIFTI, NIFTI_GZ, PAIR, VTI, VTI_GZ, RAW, RAW_GZ, UVOL, META_IMAGE = range(11)
SCALARS = bytes(range(3 * 4 * 5)) + bytes(3 * 4 * 5)  # of 3 x 4 x 5 shorts


def nrrd(encoding, data, extra="", axes="dimension: 3\nsizes: 3 4 5\nspacings: 1 2 0.5"):
    return (f"NRRD0004\n# small\ntype: short\n{axes}\nendian: little\n"
            f"encoding: {encoding}\n{extra}\n").encode() + data


def nifti(magic=b"n+1\0", steps=1):
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3 if steps == 1 else 4, 3, 4, 5, steps, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 4, 16)
    struct.pack_into("<4f", header, 76, 1, 1, 2, 0.5)
    struct.pack_into("<3f", header, 108, 352 if magic == b"n+1\0" else 0, 2, -1000)
    header[344:348] = magic
    return bytes(header) + bytes(4) + SCALARS * steps


def meta_image(data, more="", axes="NDims = 3\nDimSize = 3 4 5"):
    return (f"ObjectType = Image\n{axes}\nBinaryData = True\n{more}ElementSpacing = 1 2 0.5\nElementType = MET_SHORT\n"
            "ElementDataFile = LOCAL\n").encode() + data


def vti(data, compressor="", coding="raw"):
    return (f'<?xml version="1.0"?><VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt32"'
            f'{compressor}><ImageData WholeExtent="0 2 0 3 0 4" Origin="0 0 0" Spacing="1 2 0.5"><Piece Extent="0 2 0 3 0 4">'
            f'<PointData Scalars="s"><DataArray type="Int16" Name="s" format="appended" offset="0"/></PointData></Piece>'
            f'</ImageData><AppendedData encoding="{coding}">_').encode() + data + b"</AppendedData></VTKFile>"


def compressed_vti():
    packed = zlib.compress(SCALARS)
    head = struct.pack("<4I", 1, len(SCALARS), 0, len(packed))
    return vti(base64.b64encode(head) + base64.b64encode(packed), ' compressor="vtkZLibDataCompressor"', "base64")


def seeds():
    """Bytes by name."""
    plain_vti = vti(struct.pack("<I", len(SCALARS)) + SCALARS)
    files = {
        "nrrd": (NRRD, nrrd("raw", SCALARS)),
        "nrrd_gzip": (NRRD, nrrd("gzip", gzip.compress(SCALARS))),
        "nrrd_skip": (NRRD, nrrd("raw", b"a\nb\n" + SCALARS, "line skip: 1\nbyte skip: -1\n")),
        "nrrd_steps_together": (NRRD, nrrd("raw", SCALARS * 2, axes="dimension: 4\nsizes: 2 3 4 5\nkinds: list domain domain domain")),
        "nrrd_steps": (NRRD, nrrd("raw", SCALARS * 2, axes="dimension: 4\nsizes: 3 4 5 2\nkinds: domain domain domain time")),
        "nhdr": (NHDR, nrrd("raw", b"", "data file: a.nhdr\nbyte skip: -1\n")),
        "nifti": (NIFTI, nifti()),
        "nifti_steps": (NIFTI, nifti(steps=3)),
        "nifti_gzip": (NIFTI_GZ, gzip.compress(nifti())),
        "pair": (PAIR, nifti(b"ni1\0")),
        "vti": (VTI, plain_vti),
        "vti_gzip": (VTI_GZ, gzip.compress(plain_vti)),
        "vti_compressed": (VTI, compressed_vti()),
        "meta_image": (META_IMAGE, meta_image(SCALARS, "HeaderSize = -1\n")),
        "meta_image_steps": (META_IMAGE, meta_image(SCALARS * 2, axes="NDims = 4\nDimSize = 3 4 5 2")),
        "meta_image_compressed": (META_IMAGE, meta_image(zlib.compress(SCALARS), "CompressedData = True\n")),
        "raw": (RAW, SCALARS),
        "raw_gzip": (RAW_GZ, gzip.compress(SCALARS + SCALARS)),
    }
    return {f"{name}_{end}": bytes([2 * kind + end]) + data for name, (kind, data) in files.items() for end in (0, 1)}
