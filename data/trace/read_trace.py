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
            if part:
                break                                  # exact numbers of this chunk: see trace_column
            limit, last, step, values = {"u8": 1 << 8, "i32le": 1 << 31}.get(kind, 1 << 63), 0, 0, []
            numbers = [] if size else [0] * n
            while len(numbers) < n:                    # a block: bits of a number, then up to 32 numbers
                bits, count = data[at], min(32, n - len(numbers))
                block = int.from_bytes(data[at + 1:at + 1 + (bits * count + 7) // 8], "little")
                numbers += [block >> i * bits & (1 << bits) - 1 for i in range(count)]
                at += 1 + (bits * count + 7) // 8
            if rule == "after":
                last, step = first - 1, 1
            for v in numbers:
                if rule == "flip":
                    v ^= last
                elif rule != "plain":                  # unfold, and add what was taken away
                    v = last + step + (v >> 1 ^ -(v & 1))
                v = (v + limit) % (2 * limit) - limit
                last, step = v, v - last if rule == "line" else step
                values.append(v)
            if rule == "clock":
                values = [v + tick * period for v, tick in zip(values, trace["tick"][-n:])]
            trace[name] += values
    return trace

if __name__ == "__main__":
    trace = read_trace(sys.argv[1], *map(int, sys.argv[2:4]))
    print(",".join(trace))
    for row in zip(*trace.values()):
        print(",".join(map(str, row)))
