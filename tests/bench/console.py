#!/usr/bin/env python3
"""What the experimenter's page costs a session: lateness of the servo with and without open pages, in turns of one
session on the emulated Haply; from a tick to the page; processor time. Needs nothing beside Python.

    python3 tests/bench/console.py build/palpate [--rounds 30] [--seconds 10] [--pages 2] [--chromium]

With --chromium each page is one of its own browser, which computes on this machine too. Browsers and server stand still in
the turns without: whatever else one does in its first minutes is no cost of a page that is open."""
import argparse
import atexit
import csv
import io
import json
import os
import re
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time

MARGIN_NS = 500_000_000  # of each turn, at both ends: pages come and go
STARTS_S = 40  # a browser
SETTLES_S = 5  # after it stood still: its page listens anew


def spent(pid):
    """Processor time of a process, s."""
    fields = open(f'/proc/{pid}/stat').read().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


class Page(threading.Thread):
    """Reads the stream as a browser does. heard: (time it came, ns; time of the tick in its trial, s)."""

    def __init__(self, port, token):
        super().__init__(daemon=True)
        head = f'Host: 127.0.0.1:{port}\r\n'
        with socket.create_connection(('127.0.0.1', port)) as one:
            one.sendall(f'GET /?token={token} HTTP/1.1\r\n{head}Connection: close\r\n\r\n'.encode())
            cookie = re.search(r'Set-Cookie: ([^;]+)', one.makefile().read())[1]
        self.line = socket.create_connection(('127.0.0.1', port))
        self.line.sendall(f'GET /stream HTTP/1.1\r\n{head}Cookie: {cookie}\r\n\r\n'.encode())
        self.heard, self.gone = [], 0
        self.start()

    def run(self):
        live = False
        for text in self.line.makefile('rb'):
            if not self.gone and b'"alive":false' in text:
                self.gone = time.monotonic_ns()
            if live and text.startswith(b'data: '):
                self.heard.append((time.monotonic_ns(), json.loads(text[6:])['t']))
            live = text.startswith(b'event: live')

    def close(self):
        self.line.shutdown(socket.SHUT_RDWR)


class Browser:
    def __init__(self, port, token):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.program = subprocess.Popen(
            ['chromium', '--headless=new', '--no-sandbox', '--disable-gpu', '--no-first-run', '--remote-debugging-port=0',
             '--disable-background-networking', '--disable-component-update',
             f'--user-data-dir={self.profile.name}', f'http://127.0.0.1:{port}/?token={token}'],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        atexit.register(self.send, signal.SIGKILL)

    def send(self, number):
        os.killpg(self.program.pid, number)


def printed(program, pattern):
    """The first line of a program that has it, and reads on so that it never waits."""
    for line in program.stdout:
        if found := re.search(pattern, line):
            threading.Thread(target=program.stdout.read, daemon=True).start()
            return found
    sys.exit(f'{program.args[1]}: ended; its last words are above')


def at(share, values):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else float('nan')


def main():
    words = argparse.ArgumentParser(description=__doc__.split('\n\n')[0])
    words.add_argument('palpate')
    words.add_argument('--rounds', type=int, default=30)
    words.add_argument('--seconds', type=float, default=10)
    words.add_argument('--pages', type=int, default=2)
    words.add_argument('--chromium', action='store_true')
    plan = words.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        file = folder + '/d.sqlite'
        study = open(os.path.dirname(__file__) + '/../golden/four_trials.toml').read()
        with open(folder + '/long.toml', 'w') as out:  # soft: emulated motors grow warm, too
            out.write(study.replace('n_per_m = 1000', 'n_per_m = 150').replace('\nrepetitions = 1', '\nrepetitions = 200'))
        run = subprocess.Popen([plan.palpate, 'run', folder + '/long.toml', '--device', 'haply-emulator', '--headless',
                                '--participant', 'P1', '--operator', 'bench', '--db', file],
                               stdout=subprocess.PIPE, text=True)
        atexit.register(run.kill)
        printed(run, r'^#1 ')
        console = subprocess.Popen([plan.palpate, 'console', file], stdout=subprocess.PIPE, text=True)
        atexit.register(console.kill)
        port, token = printed(console, r':(\d+)/\?token=(\w+)').groups()
        browsers = [Browser(port, token) for _ in range(plan.pages * plan.chromium)]
        time.sleep(STARTS_S * plan.chromium)
        turns, heard = [], []  # turns: (open, from, to, spent by session, by server)
        for turn in range(2 * plan.rounds):
            pages = [] if plan.chromium else [Page(int(port), token) for _ in range(plan.pages * (turn % 2))]
            for browser in browsers:
                browser.send(signal.SIGCONT if turn % 2 else signal.SIGSTOP)
                console.send_signal(signal.SIGCONT if turn % 2 else signal.SIGSTOP)
            time.sleep(SETTLES_S * plan.chromium)
            begun, before = time.monotonic_ns(), (spent(run.pid), spent(console.pid))
            time.sleep(plan.seconds)
            turns.append((turn % 2 == 1, begun + MARGIN_NS, time.monotonic_ns() - MARGIN_NS,
                          spent(run.pid) - before[0], spent(console.pid) - before[1]))
            for page in pages:
                page.close()
                heard.append(page.heard)
        for browser in browsers:
            browser.send(signal.SIGKILL)
        pages = [Page(int(port), token) for _ in range(plan.pages)]
        time.sleep(2)
        if run.poll() is not None:
            sys.exit('the session ended before it was measured: this machine is too busy, or the rounds too many')
        killed = time.monotonic_ns()
        run.kill()
        run.wait()
        time.sleep(2)
        gone = max(page.gone for page in pages) - killed
        before = spent(console.pid)
        time.sleep(plan.seconds)
        after_end = 100 * (spent(console.pid) - before) / plan.seconds
        console.terminate()
        console.wait()
        trials = [row for row in sqlite3.connect(file).execute(
            'SELECT trial_id, started_ns FROM trial WHERE started_ns IS NOT NULL ORDER BY started_ns')]
        started = dict(trials)
        ticks = subprocess.run([plan.palpate, 'sql', file, '--csv', '--steps', '2000000000', '-c',
                                'SELECT trial_id, time_s, lateness_us FROM sample'],
                               stdout=subprocess.PIPE, text=True, check=True).stdout
    late = {True: [], False: []}
    for row in csv.DictReader(io.StringIO(ticks)):
        when = started[int(row['trial_id'])] + 1e9 * float(row['time_s'])
        for is_open, begin, end, *_ in turns:
            if begin <= when < end:
                late[is_open].append(float(row['lateness_us']))
    delays, gaps = [], []
    for page in heard:
        for came, t in page:
            begun = [ns for _, ns in trials if ns + 1e9 * t <= came]
            delays += [1e-6 * (came - begun[-1]) - 1e3 * t] if begun else []
        gaps += [1e-6 * (b[0] - a[0]) for a, b in zip(page, page[1:])]
    seconds = plan.rounds * plan.seconds
    for name, share in (('p50', 0.5), ('p99', 0.99), ('worst', 1)):
        without, with_pages = at(share, late[False]), at(share, late[True])
        print(f'servo lateness {name}: {without:.1f} us without, {with_pages:.1f} us with {plan.pages} pages '
              f'({with_pages / without:.3f})')
    print(f'  of {len(late[False])} and {len(late[True])} ticks in {plan.rounds} turns of {plan.seconds:g} s each')
    if delays:
        print(f'from a tick to the page: p50 {at(0.5, delays):.0f} ms, p99 {at(0.99, delays):.0f} ms; '
              f'{1000 / at(0.5, gaps):.0f} updates a second (half of the gaps shorter)')
    for who, column in (('the session', 3), ('the server', 4)):
        with_pages, without = (100 * sum(turn[column] for turn in turns if turn[0] is is_open) / seconds
                               for is_open in (True, False))
        print(f'processor time of {who}: {with_pages:.2f} % of a core with pages, {without:.2f} % without')
    print(f'from the death of the session to the last page: {1e-6 * gone:.0f} ms')
    print(f'processor time of the server with {plan.pages} pages on a session that is over: {after_end:.2f} % of a core')


main()
