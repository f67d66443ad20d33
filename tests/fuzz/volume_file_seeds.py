# SPDX-License-Identifier: Apache-2.0
"""Small volumes in every format, as initial inputs of volume_file_fuzzer. Half of an input's first byte (rounded down) chooses
the name that the fuzzer gives to the rest, and the byte's lowest bit which end is read."""

import base64
import gzip
import struct
import zlib

(NRRD, NHDR, NIFTI, NIFTI_GZ, PAIR, VTI, VTI_GZ, RAW, RAW_GZ, UVOL, META_IMAGE, DICOM, TIFF, ZARR_2, ZARR_3, OME_ZARR) = range(16)
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


def dicom_element(group, element, representation, value):
    value += b"\0" * (len(value) % 2)
    head = struct.pack("<HH2s", group, element, representation)
    long_form = representation in (b"OB", b"OW", b"SQ", b"UN", b"UT")
    return head + (struct.pack("<HI", 0, len(value)) if long_form else struct.pack("<H", len(value))) + value


def dicom(syntax=b"1.2.840.10008.1.2.1", pixels=None, frames=5):
    """A file with several frames of 3 x 4 shorts, explicit little endian."""
    def number(value):
        return struct.pack("<H", value)

    meta = dicom_element(2, 0x10, b"UI", syntax)
    meta = dicom_element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta
    body = b"".join(dicom_element(*one) for one in (
        (8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.7.3"), (8, 0x18, b"UI", b"1.2.3.4"), (8, 0x60, b"CS", b"CT"),
        (0x20, 0xD, b"UI", b"1.2.3"), (0x20, 0xE, b"UI", b"1.2.3.5"), (0x20, 0x13, b"IS", b"1"),
        (0x20, 0x32, b"DS", b"0\\0\\0"), (0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0"),
        (0x28, 2, b"US", number(1)), (0x28, 4, b"CS", b"MONOCHROME2"), (0x28, 8, b"IS", str(frames).encode()),
        (0x28, 0x10, b"US", number(4)), (0x28, 0x11, b"US", number(3)), (0x28, 0x30, b"DS", b"2\\1"),
        (0x28, 0x100, b"US", number(16)), (0x28, 0x101, b"US", number(16)), (0x28, 0x102, b"US", number(15)),
        (0x28, 0x103, b"US", number(1)), (0x28, 0x1052, b"DS", b"-1000"), (0x28, 0x1053, b"DS", b"2")))
    return bytes(128) + b"DICM" + meta + body + (pixels or dicom_element(0x7FE0, 0x10, b"OW", SCALARS))


def dicom_run_length():
    """One frame: two byte planes, each as a run of 12 literals."""
    low, high = SCALARS[0:24:2], SCALARS[1:24:2]
    segment = bytes([11]) + low
    frame = struct.pack("<16I", 2, 64, 64 + len(segment), *([0] * 13)) + segment + bytes([11]) + high
    item = struct.pack("<HHI", 0xFFFE, 0xE000, 0) + struct.pack("<HHI", 0xFFFE, 0xE000, len(frame)) + frame
    pixels = struct.pack("<HH2sHI", 0x7FE0, 0x10, b"OB", 0, 0xFFFFFFFF) + item + struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    return dicom(b"1.2.840.10008.1.2.5", pixels, 1)


def tiff(compression=1, tiled=False, description=b""):
    """Pages of 3 x 4 shorts, tiled or not."""
    out = bytearray(b"II*\0\0\0\0\0")
    link = 4
    for page in range(5):
        data = bytes(512) if tiled else SCALARS[24 * page:24 * page + 24]
        data = zlib.compress(data) if compression == 8 else data
        place = len(out)
        out += data + bytes(len(data) % 2)
        text = len(out)
        out += description + bytes(2 - len(description) % 2)
        tags = [(256, 4, 3), (257, 4, 4), (258, 3, 16), (259, 3, compression), (262, 3, 1), (277, 3, 1), (339, 3, 2)]
        tags += [(322, 4, 16), (323, 4, 16), (324, 4, place), (325, 4, len(data))] if tiled else [
            (273, 4, place), (278, 4, 4), (279, 4, len(data))]
        entries = [struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags]
        if description:
            entries.append(struct.pack("<HHII", 270, 2, len(description) + 1, text))
        entries.sort(key=lambda entry: struct.unpack("<H", entry[:2]))
        struct.pack_into("<I", out, link, len(out))
        out += struct.pack("<H", len(entries)) + b"".join(entries) + bytes(4)
        link = len(out) - 4
    return bytes(out)


def zarr(metadata, chunk):
    """Input from which the fuzzer makes the two files of a folder."""
    return metadata.encode() + b"\0" + chunk


def zarr_2(compressor="null", chunk=SCALARS):
    return zarr(f'{{"zarr_format":2,"shape":[5,4,3],"chunks":[5,4,3],"dtype":"<i2","order":"C","fill_value":0,"filters":null,'
                f'"compressor":{compressor}}}', chunk)


def zarr_3(codecs, chunk):
    return zarr('{"zarr_format":3,"node_type":"array","shape":[5,4,3],"data_type":"int16","chunk_grid":{"name":"regular",'
                '"configuration":{"chunk_shape":[5,4,3]}},"chunk_key_encoding":{"name":"default","configuration":'
                f'{{"separator":"/"}}}},"fill_value":0,"codecs":[{codecs}]}}', chunk)


LITTLE_ENDIAN = '{"name":"bytes","configuration":{"endian":"little"}}'


def zarr_shard():
    index = struct.pack("<QQ", 16, len(SCALARS))
    codecs = ('{"name":"sharding_indexed","configuration":{"chunk_shape":[5,4,3],"codecs":[' + LITTLE_ENDIAN
              + '],"index_codecs":[' + LITTLE_ENDIAN + '],"index_location":"start"}}')
    return zarr_3(codecs, index + SCALARS)


def ome_zarr():
    """A group, and the single level of its image."""
    group = ('{"zarr_format":3,"node_type":"group","attributes":{"ome":{"version":"0.5","multiscales":[{"axes":['
             '{"name":"c","type":"channel"},{"name":"z","type":"space","unit":"micrometer"},{"name":"y","type":"space"},'
             '{"name":"x","type":"space","unit":"nanometer"}],"datasets":[{"path":"0","coordinateTransformations":['
             '{"type":"scale","scale":[1,2,0.5,250]}]}]}]}}}')
    level = ('{"zarr_format":3,"node_type":"array","shape":[2,5,4,3],"data_type":"int16","chunk_grid":{"name":"regular",'
             '"configuration":{"chunk_shape":[1,5,4,3]}},"chunk_key_encoding":{"name":"default"},"fill_value":-7,'
             '"codecs":[' + LITTLE_ENDIAN + ']}')
    return group.encode() + b"\0" + level.encode() + b"\0" + SCALARS


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
        "dicom": (DICOM, dicom()),
        "dicom_run_length": (DICOM, dicom_run_length()),
        "tiff": (TIFF, tiff()),
        "tiff_deflated": (TIFF, tiff(8)),
        "tiff_tiled": (TIFF, tiff(tiled=True)),
        "tiff_imagej": (TIFF, tiff(description=b"ImageJ=1.53\nimages=5\nframes=5\nspacing=2\nunit=um\n")),
        "zarr_2": (ZARR_2, zarr_2()),
        "zarr_2_zlib": (ZARR_2, zarr_2('{"id":"zlib"}', zlib.compress(SCALARS))),
        "zarr_3": (ZARR_3, zarr_3(LITTLE_ENDIAN + ',"gzip"', gzip.compress(SCALARS))),
        "zarr_3_transposed": (ZARR_3, zarr_3('{"name":"transpose","configuration":{"order":[2,0,1]}},' + LITTLE_ENDIAN, SCALARS)),
        "zarr_3_shard": (ZARR_3, zarr_shard()),
        "ome_zarr": (OME_ZARR, ome_zarr()),
        "raw": (RAW, SCALARS),
        "raw_gzip": (RAW_GZ, gzip.compress(SCALARS + SCALARS)),
    }
    return {f"{name}_{end}": bytes([2 * kind + end]) + data for name, (kind, data) in files.items() for end in (0, 1)}
