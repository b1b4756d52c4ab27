#!/usr/bin/env python3
"""Ticks of one trial of a palpate database, with nothing but Python's standard library.

usage: read_trace.py FILE TRIAL [COLUMN ...]     (writes CSV)
"""
import pathlib, sqlite3, struct, sys, zlib

CODES = {"f64le": "d", "f32le": "f", "i64le": "q", "i32le": "i", "i16le": "h", "u8": "B"}

def read_trace(file, trial):
    """{column: [values]} of all ticks; the chunks' checksums are checked."""
    db = sqlite3.connect(pathlib.Path(file).resolve().as_uri() + "?mode=ro", uri=True)
    columns = db.execute("SELECT name, type FROM trace_column WHERE codec = 1 ORDER BY position").fetchall()
    trace = {name: [] for name, _ in columns}
    chunks = "SELECT ticks, crc32, data FROM trace_chunk WHERE trial = ? ORDER BY first_tick"
    for ticks, crc, data in db.execute(chunks, (trial,)):
        raw, at = zlib.decompress(data), 0
        if zlib.crc32(raw) != crc:
            raise ValueError(f"trial {trial}: a chunk is damaged")
        for name, kind in columns:
            size = struct.calcsize("<" + CODES[kind])
            block, at = raw[at:at + size * ticks], at + size * ticks
            values = bytearray(size * ticks)
            for byte in range(size):                   # undo the shuffle: byte k of every value
                values[byte::size] = block[byte * ticks:(byte + 1) * ticks]
            trace[name] += struct.unpack(f"<{ticks}{CODES[kind]}", values)
    return trace

if __name__ == "__main__":
    trace = read_trace(sys.argv[1], int(sys.argv[2]))
    names = sys.argv[3:] or list(trace)
    print(",".join(names))
    for row in zip(*(trace[name] for name in names)):
        print(",".join(map(repr, row)))
