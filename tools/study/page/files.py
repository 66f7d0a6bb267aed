# SPDX-License-Identifier: BSD-3-Clause


def write_whole(path, data):
    """Bytes into a file that gets its name when it is whole."""
    part = path.with_name(path.name + ".part")
    try:
        part.write_bytes(data)
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise
