#!/usr/bin/env python3
"""Stored ticks of one trial of a palpate database, with nothing but Python's standard library.

usage: read_trace.py FILE TRIAL [INTERVAL]     (writes CSV; number * scale of trace_column is in its unit)
"""
import pathlib, sqlite3, struct, sys, zlib

def read_trace(file, trial, interval=1):
    """{column: [whole numbers]} of all ticks that codec 1 holds as such; every checksum is checked."""
    db = sqlite3.connect(pathlib.Path(file).resolve().as_uri() + "?mode=ro", uri=True)
    columns = db.execute("SELECT name, type, rule, part FROM trace_column WHERE codec = 1 ORDER BY column_position").fetchall()
    trace = {name: [] for name, _, _, part in columns if not part}
    chunks = """SELECT first_tick, ticks, period_ns, holds, crc32, data FROM trace_chunk
                WHERE trial_id = ? AND interval = ? AND codec = 1 ORDER BY first_tick"""
    for first, n, period, holds, crc, data in db.execute(chunks, (trial, interval)):
        if zlib.crc32(data) != crc:
            raise ValueError(f"trial {trial}: the chunk of tick {first} is damaged")
        held = [c for c in columns if not c[3] or c[3] in holds.split()]
        at = 4 * len(held)
        for (name, kind, rule, part), size in zip(held, struct.unpack_from(f"<{len(held)}I", data)):
            width = {"u8": 1, "i16le": 2, "f32le": 4, "i32le": 4}.get(kind, 8)
            block = zlib.decompress(data[at:at + size]) if size else bytes(width * n)
            at += size
            if part:
                continue                               # exact numbers of this chunk: see trace_column
            whole, limit = bytearray(width * n), 1 << 8 * width - 1
            for byte in range(width):                  # undo the shuffle: byte k of every value
                whole[byte::width] = block[byte * n:(byte + 1) * n]
            values = struct.unpack(f"<{n}{'BHIQ'[width.bit_length() - 1]}", whole)
            if rule != "plain":                        # unfold, and add up what was taken away
                last, step, sums = (first - 1, 1, []) if rule == "after" else (0, 0, [])
                for v in values:
                    last = (last + (v >> 1 ^ -(v & 1)) + step + limit) % (2 * limit) - limit
                    sums.append(last)
                ticks = trace["tick"][-n:]
                values = [s + t * period for s, t in zip(sums, ticks)] if rule == "clock" else sums
            trace[name] += values
    return trace

if __name__ == "__main__":
    trace = read_trace(sys.argv[1], *map(int, sys.argv[2:4]))
    print(",".join(trace))
    for row in zip(*trace.values()):
        print(",".join(map(str, row)))
