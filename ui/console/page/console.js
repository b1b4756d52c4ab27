// The experimenter's page: shows what /stream tells of the running session, and posts what is asked for to /do.
(function () {
  'use strict';
  const QUIET_S = 1.6;   // no event for longer: the stream is lost (there is one a second at least)
  const AGAIN_S = 5;     // a lost stream is asked for again
  const SHOWN_S = 4;     // of the strips, swept from left to right; the newest is before the gap
  const GAP_S = 0.15;
  const SAID_S = 4;      // an answer is of its step of the session, but long enough to be read
  const DRAWN_S = 0.09;  // what is felt is drawn so often: a browser paints where the servo computes
  const TIMES_S = 4.5;   // what runs on by itself is written anew so often (5 s), where nothing is revealed, and at each step
  const ARROW_M = 0.01;  // of a newton, in the drawing
  const ROUND_M = 0.025; // around the outline
  const KINDS = { real: 'REAL', pilot: 'PILOT', simulated: 'SIMULATED' };
  const SHAPES = {
    welcome: '\u25cb', ready: '\u25cb', explore: '\u25cf', question: '?', feedback: '=', gap: '\u2026', break: '\u2225',
    pause: '\u2225', trouble: '\u25b2', ended: '\u25a0'
  };
  const ENDS = {
    finished: ['The session is finished.', 'Every trial of it is done. Nothing more can be changed from this page.'],
    'ended early': ['The session was ended early.', 'What was recorded is kept; the same run command goes on later.'],
    killed: ['The session is gone.', 'Its program was killed, or fell. Look at the handle: if it still pulls, switch off ' +
      'the supply of the motors. What was saved is kept; the same run command goes on.']
  };
  const $ = id => document.getElementById(id);

  let state = null;       // the newest event `state`, and when it came, s
  let stateAt = 0;
  let heardAt = 0;        // any event
  let lost = null;        // why the stream is lost
  let live = null;
  let source = null;
  let triedAt = 0;
  let asked = false;      // this page asked for what is felt

  const seconds = () => performance.now() / 1000;
  const NO_FORCE = 'No force any more.';
  const UNPROVED = 'Nothing proves that the motors are off: hands off the handle, switch off the motors\u2019 supply.';
  const is = value => value !== null && value !== undefined;
  /// Only what is another value is written: nothing else is laid out and painted again.
  function set(of, name, value) {
    if (of[name] !== value) of[name] = value;
  }
  const put = (node, text) => set(node, 'textContent', text);
  function make(name, text, className) {
    const node = document.createElement(name);
    if (is(text)) node.textContent = text;
    if (className) node.className = className;
    return node;
  }
  /// Fills `node` anew, only if `key` is another one than last time: what is unchanged keeps focus and place.
  const filled = new Map();
  function fill(node, key, children) {
    const text = JSON.stringify(key);
    if (filled.get(node) === text) return;
    filled.set(node, text);
    node.replaceChildren(...children());
  }
  /// Rows [name, text, is bad] of a dl; those without text are left out.
  function facts(node, rows) {
    rows = rows.filter(row => is(row[1]));
    fill(node, rows.map(row => row[0]), () => rows.map(row => {
      const pair = make('div');
      pair.append(make('dt', row[0]), make('dd'));
      return pair;
    }));
    rows.forEach((row, i) => {
      put(node.children[i].lastChild, row[1]);
      set(node.children[i].lastChild, 'className', row[2] ? 'bad-word' : '');
    });
  }
  const counted = (n, one, more) => n + ' ' + (n === 1 ? one : more || one + 's');
  const ago = ms => ms < 1000 ? Math.round(ms) + ' ms ago' : ms < 120000 ? (ms / 1000).toFixed(1) + ' s ago'
    : Math.round(ms / 60000) + ' min ago';
  const lasted = s => s < 60 ? Math.floor(s) + ' s' : Math.floor(s / 60) + ' min ' + Math.floor(s % 60) + ' s';
  const worded = code => /^[a-z_]+$/.test(code) ? code.replace(/_/g, ' ') : code;
  const over = () => state !== null && (state.phase === 'ended' || is(state.ended));
  const rests = () => over() && state.ended !== 'killed';
  const gone = () => !rests() && (lost !== null || (state !== null && (!state.alive || is(state.silent_s))));
  const named = one => (one.practice ? 'Practice ' : 'Trial ') + one.trial;

  // ------------------------------------------------------------------------------------------ what is shown

  function banners() {
    const all = [];
    if (state && is(state.ended)) {
      const said = ENDS[state.ended] || ['The session has ended: ' + state.ended + '.', ''];
      all.push([state.ended === 'killed', said[0], said[1]]);
    } else if (state && !state.alive) {
      all.push([true, ...ENDS.killed]);
    } else if (lost === null && state && is(state.silent_s)) {
      all.push([true, 'The session does not answer.', 'It hangs, or was stopped. Nothing shows whether there is force: hands off ' +
        'the handle, switch off the motors\u2019 supply. What stands below is old.']);
    } else if (lost !== null) {
      all.push([true, 'This page has lost the session.', lost + ' What stands below is old. The session may still run: see ' +
        'its window and its terminal; the chords work there.']);
    }
    if (state && !over()) {
      if (state.phase === 'trouble') {
        all.push([!state.solved, state.solved ? 'The trouble is over: at the participant\u2019s screen it goes on.'
          : !is(state.force.on) ? 'Trouble: the motors may still give force.'
          : 'Trouble: no force until it is mended.', state.sentence]);
      }
      if (state.alarm) {
        all.push([true, 'Three of the last six trials do not count.', 'Pause, and look at what they have in common: the ' +
          'reasons stand under Trials.']);
      }
    }
    fill($('alerts'), all, () => all.map(one => {
      const box = make('div', null, one[0] ? 'banner bad' : 'banner');
      box.append(make('b', (one[0] ? '\u25b2 ' : '\u25a0 ') + one[1]), make('span', one[2]));
      return box;
    }));
  }

  function showForce() {
    const now = gone() || !is(state.force.on) ? 'unknown' : rests() ? 'off' : state.force.on ? 'on' : 'off';
    if (now === 'on' && $('said').textContent === NO_FORCE) say(true, '');
    set(document.body.dataset, 'force', now);
    put($('force-word'), now === 'unknown' ? 'Force not known' : 'Force ' + now);
    put($('force-why'), gone() || (over() && now === 'off') || !state.force.why || state.phase === 'trouble' ? ''
      : '(' + state.force.why + ')');
  }

  function trialRows() {
    const rows = [
      ['Remaining', counted(state.remaining, 'trial') + (is(state.remaining_min) && state.remaining > 0
        ? ', some ' + Math.max(1, Math.round(state.remaining_min)) + ' min at this pace' : '')],
      ['Next break', is(state.next_break_in) ? 'after ' + counted(state.next_break_in, 'more trial') : 'none'],
      ['Do not count, of this run', String(state.not_counting.length)],
      ['Faults of this run', String(state.faults.length)]
    ];
    facts($('trials'), rows);
    set($('not-h'), 'hidden', state.not_counting.length === 0);
    set($('faults-h'), 'hidden', state.faults.length === 0);
    fill($('not'), state.not_counting, () => state.not_counting.slice().reverse()
      .map(one => make('li', named(one) + ': ' + worded(one.why))));
    fill($('faults'), state.faults, () => state.faults.slice().reverse().map(one => {
      const item = make('li', (is(one.trial) ? named(one) + ': ' : '') + worded(one.cause));
      item.append(make('small', one.advice));
      return item;
    }));
  }

  function rigRows() {
    const d = state.device;
    const none = 'none';
    facts($('rig'), [
      ['Device', d.name],
      ['Calibration', d.calibration || none],
      ['Round trip', is(d.round_trip_us) ? Math.round(d.round_trip_us) + ' µs' : 'not measured'],
      ['Rig check', d.check || none],
      ['Watchdog', d.watchdog || none],
      ['Dead-man key', d.dead_man ? 'held' : 'not needed now']
    ]);
  }

  function keptRows() {
    const sound = state.masking;
    const saved = is(state.saved_ms) ? state.saved_ms + 1000 * (seconds() - stateAt) : null;
    facts($('kept'), [
      ['Saved', over() ? null : saved === null ? 'nothing yet' : ago(saved)],
      ['Disk', is(state.disk_free_mb) ? (state.disk_free_mb / 1000).toFixed(1) + ' GB free' : null, state.disk_free_mb < 1000],
      ['Newest seal', state.seal || 'none yet'],
      ['Masking noise', !sound ? 'none' : (sound.on ? 'on' : 'off') +
        (is(sound.level_db) ? ', ' + sound.level_db + ' dB of full scale' : '')],
      ['Session', state.session]
    ]);
  }

  /// Bins by their edges: as many counts as edges + 1 (below, between, above), or fewer at either end.
  function lateRows() {
    const late = state.late;
    facts($('late'), [
      ['Stale ticks', (100 * late.stale_share).toFixed(late.stale_share < 0.001 ? 3 : 1) + ' %', late.stale_share > 0.01],
      ['Newest', live && is(live.late_us) ? Math.round(live.late_us) + ' µs' : null]
    ]);
    const edges = late.edges_us, below = late.session.length > edges.length;
    const names = late.session.map((n, i) => {
      const from = below ? i - 1 : i;
      return from < 0 ? 'under ' + edges[0] : from + 1 < edges.length ? edges[from] + ' to ' + edges[from + 1]
        : edges[from] + ' or more';
    });
    const rows = names.slice(0, 1 + Math.max(...late.session.map((n, i) => n > 0 ? i : 0)));
    fill($('late-rows'), rows, () => rows.map(name => {
      const row = make('tr'), head = make('th', name);
      head.scope = 'row';
      row.append(head, ...[0, 0].map(() => {
        const cell = make('td'), bar = make('i');
        bar.ariaHidden = 'true';
        cell.append(bar, make('span'));
        return cell;
      }));
      return row;
    }));
    [late.trial, late.session].forEach((counts, k) => rows.forEach((name, i) => {
      const [bar, text] = $('late-rows').children[i].children[k + 1].children, n = counts[i] || 0;
      put(text, String(n));
      set(bar, 'hidden', n === 0);
      set(bar.style, 'width', Math.round(10 * Math.log1p(n) / Math.log1p(Math.max(1, ...counts))) / 4 + 'em');
    }));
  }

  function notes() {
    fill($('notes'), state.notes, () => state.notes.slice().reverse().map(note => {
      const item = make('li', note.text), at = new Date(note.at);
      item.append(make('small', (isNaN(at) ? note.at : at.toLocaleTimeString()) +
        (is(note.trial) ? ', ' + named(note).toLowerCase() : '')));
      return item;
    }));
    set($('notes'), 'hidden', state.notes.length === 0);
  }

  const goesOn = () => state !== null && (state.phase === 'pause' || state.phase === 'trouble' || state.pausing === true);
  const looks = () => state !== null && state.act === false;
  /// Why what is pressed is not asked for; empty: it is. A page that hears nothing may still be heard: no force, then.
  const barred = id => over() ? 'the session has ended' : looks() ? 'this page may only look'
    : id !== 'stop' && (state === null || gone()) ? 'this page has no session to ask'
    : id === 'pause' && state.phase === 'trouble' ? 'at the participant\u2019s screen alone, where the handle is seen' : '';
  function buttons() {
    ['stop', 'pause', 'mark', 'end', 'reveal', 'note-send'].forEach(id => set($(id), 'ariaDisabled', String(barred(id) !== '')));
    put($('pause-word'), goesOn() ? 'Go on' : 'Pause');
    put($('hint'), over() ? 'Nothing can be asked of a session that is over.' : looks() ? 'This page may only look; the chords are ' +
      'those of the participant\u2019s window.' : 'Esc works on this page, too; the other chords are those of the participant\u2019s window.');
  }

  const shows = () => state !== null && state.reveal === 'shown' && is(state.hidden);
  function hidden() {
    const shown = shows();
    set($('shown'), 'hidden', !shown);
    set($('covered'), 'hidden', shown);
    set($('reveal'), 'hidden', state.reveal !== 'ask' || over());
    if (state.reveal === 'never') {
      put($('blind'), 'Not shown: the protocol says reveal = "never".');
    }
    if (!shown) return;
    const h = state.hidden;
    facts($('hidden'), [['Object', h.object], ['Friction', h.friction], ['Level', is(h.level) ? String(h.level) : null]]);
    fill($('scene'), h.outline || 0, () => {
      marked = null;
      return [];
    });
    fill($('answers'), h.answers, () => h.answers.slice().reverse().map(one => {
      const row = make('tr', null, one.correct === false ? 'wrong' : '');
      [(one.practice ? 'practice ' : '') + one.trial, one.object, one.friction, one.answer, one.correct === true ? 'right' : one.correct === false ? '\u2715 wrong'
        : 'neither'].forEach(text => row.append(make('td', is(text) ? String(text) : '')));
      return row;
    }));
    const newtons = live && is(live.f) ? Math.hypot(live.f[0], live.f[1]) : 0;
    const mm = p => is(p) ? (1000 * p[0]).toFixed(1) + ', ' + (1000 * p[1]).toFixed(1) + ' mm' : 'none';
    put($('scene-text'), (gone() ? 'As it was last heard. ' : '') + (!live || !is(live.hip) ? 'No hand was seen yet.'
      : 'Disc: hand (HIP) at ' + mm(live.hip) + '. Square: god-object at ' + mm(live.go) + '. Arrow: force, ' + newtons.toFixed(2) + ' N; 10 mm is 1 N.'));
    draw();
  }

  function clock() {
    const runs = state && is(state.phase_s) && !gone() && !over(), since = runs ? state.phase_s + seconds() - stateAt : 0;
    put($('seconds'), (since >= 1 ? ', ' + lasted(since) : '') + (runs && state.pausing && state.phase !== 'pause' ? ', then a pause' : ''));
    const late = seconds() - heardAt + (state && state.silent_s || 0);
    put($('link'), heardAt === 0 ? 'waiting for the session' : over() ? 'The session is over; this page rests.'
      : gone() ? 'As it was ' + Math.round(late) + ' s ago.'
      : 'In touch with the session.');
  }

  function show() {
    set(document.body, 'className', gone() ? 'gone' : '');
    banners();
    buttons();
    if (!state) return;
    set(document.body.dataset, 'phase', state.phase);
    set(document.body.dataset, 'kind', state.kind);
    put($('kind'), KINDS[state.kind] || state.kind);
    put($('participant'), state.participant);
    put($('number'), 'session ' + state.number);
    put($('title'), state.title);
    put($('protocol'), state.title === state.protocol ? '' : '(' + state.protocol + ')');
    put($('shape'), SHAPES[state.phase] || '');
    const trial = (state.practice ? 'practice ' : '') + 'trial ' + state.trial + ' of ' + state.trials;
    put($('sentence'), (gone() ? 'last heard: ' : '') + (state.phase === 'trouble' ? 'trouble' + (state.trial > 0 ? ' in ' + trial : '')
      : state.sentence));
    const all = state.answered + state.remaining;
    set($('bar'), 'max', Math.max(1, all));
    set($('bar'), 'value', state.answered);
    put($('left'), state.answered + ' of ' + all + ' answered, ' + state.remaining + ' remain');
    set(document, 'title', (gone() ? 'LOST \u00b7 ' : '') + state.participant + ' \u00b7 ' + state.phase + ' \u00b7 palpate');
    showForce();
    trialRows();
    rigRows();
    notes();
    hidden();
    times();
  }
  let timesAt = 0;
  let timesOf = '';
  function times() {
    const of = [state.phase, state.trial, state.pausing, gone(), over()].join();
    if (of === timesOf && !shows() && seconds() - timesAt < TIMES_S) return;
    timesOf = of;
    timesAt = seconds();
    keptRows();
    lateRows();
    clock();
  }

  // ---------------------------------------------------------------------------- what is drawn when it is revealed

  const MODES = ['free', 'stuck', 'slip'];
  const STRIPS = [  // lines: which of a tick, ink, width
    { title: 'Force, N: normal thick, friction thin', lines: [[1, '--blue', 3], [2, '--vermillion', 1.25]], least: 1, from: 0, to: 0.4 },
    { title: 'Speed of the hand, mm/s', lines: [[3, '--blue', 2]], least: 10, from: 0.4, to: 0.7 },
    { title: 'Mode of the contact', lines: [[4, '--green', 2]], names: MODES, from: 0.7, to: 0.95 }
  ];
  let ticks = [];        // [t s, normal N, friction N, speed mm/s, mode], oldest first
  let swept = null;      // time of the newest that is drawn; null: draw all anew
  let marked = null;     // where the marks of the scene are drawn; null: draw it anew
  let drawnAt = 0;
  let seen = false;      // it is on the screen
  let rem = 16;          // of the page, in pixels of the screen
  const inks = {};

  function keep(more) {
    if (more.t.length === 0) return;
    more.t.forEach((t, i) => {
      if (ticks.length > 0 && t < ticks[ticks.length - 1][0]) {  // another interval, maybe amid what came at once
        ticks = [];
        swept = null;
      }
      ticks.push([t, more.fn[i], more.ft[i], 1000 * more.speed[i], MODES.indexOf(more.mode[i])]);
    });
    const from = ticks[ticks.length - 1][0] - SHOWN_S + GAP_S;
    ticks = ticks.slice(ticks.findIndex(tick => tick[0] >= from));
  }

  function draw() {
    drawnAt = seconds();
    if (!seen) return;
    drawStrips();
    drawScene();
  }

  /// The smallest of 1, 2, 5, 10, ... that is no smaller than `max`.
  function round(max) {
    const ten = Math.pow(10, Math.floor(Math.log10(max)));
    return ten * [1, 2, 5, 10].find(n => n * ten >= max * (1 - 1e-9));
  }

  function drawStrips() {
    const canvas = $('strips'), c = canvas.getContext('2d'), left = 3.5 * rem, thin = Math.max(1, rem / 16);
    const x = t => left + (canvas.width - left) * (t % SHOWN_S) / SHOWN_S;
    STRIPS.forEach(strip => {
      const all = strip.lines.flatMap(line => ticks.map(tick => tick[line[0]])), low = Math.min(0, ...all);
      const range = strip.names ? [-0.4, strip.names.length - 0.6]
        : [low < 0 ? -round(-low) : 0, round(Math.max(strip.least, ...all))];
      if (String(strip.range) !== String(range)) swept = null;
      strip.range = range;
      const top = canvas.height * strip.from + 1.8 * rem, high = canvas.height * strip.to - 0.6 * rem - top;
      strip.y = value => top + high * (range[1] - value) / (range[1] - range[0]);
      strip.marks = strip.names ? strip.names.map((name, i) => i) : [range[0], 0, range[1] / 2, range[1]];
      strip.rule = at => c.fillRect(at, top, thin, high);
      strip.clear = (at, width) => c.clearRect(at, top - 0.3 * rem, width, high + (strip.names ? 2.4 : 0.9) * rem);
    });
    function clear(from, to) {
      c.fillStyle = inks['--rule'];
      STRIPS.forEach(strip => strip.clear(from, to - from));  // not its title
      STRIPS.forEach(strip => strip.marks.forEach(at => c.fillRect(from, strip.y(at), to - from, thin)));
    }
    if (ticks.length === 0 && swept !== null) return;
    const newest = ticks.length > 0 ? ticks[ticks.length - 1][0] : 0, first = swept === null ? 0 : ticks.findIndex(tick => tick[0] > swept);
    if (first < 0) return;
    if (swept === null) {
      c.clearRect(0, 0, canvas.width, canvas.height);
      clear(left, canvas.width);
      c.fillStyle = inks['--text'];
      STRIPS.forEach(strip => {
        c.textAlign = 'left';
        c.font = '600 ' + 0.85 * rem + 'px sans-serif';
        c.fillText(strip.title, 0, canvas.height * strip.from + rem);
        c.textAlign = 'right';
        c.font = 0.8 * rem + 'px sans-serif';
        strip.marks.forEach(at => c.fillText(strip.names ? strip.names[at] : at, left - 0.4 * rem, strip.y(at) + 0.3 * rem));
      });
    } else {
      const from = Math.round(x(swept)) + 1, to = Math.round(x(newest + GAP_S));
      if (from < to) clear(from, to);
      else [[from, canvas.width], [left, to]].forEach(part => clear(...part));
    }
    for (let whole = Math.floor(swept || (ticks.length > 0 ? ticks[0][0] : 0)) + 1; whole <= newest; ++whole) {
      c.fillStyle = inks['--rule'];
      STRIPS.forEach(strip => strip.rule(x(whole)));
      c.fillStyle = inks['--text'];
      if (whole % SHOWN_S !== 0) c.fillText(whole + ' s', x(whole), canvas.height - 0.3 * rem);
    }
    STRIPS.forEach(strip => strip.lines.forEach(([which, ink, width]) => {
      c.beginPath();
      ticks.slice(Math.max(0, first - 1)).forEach((tick, i, all) => {
        const at = x(tick[0]), before = i > 0 ? all[i - 1] : tick;
        if (x(before[0]) > at || i === 0) c.moveTo(at, strip.y(tick[which]));
        else if (strip.names) c.lineTo(at, strip.y(before[which]));
        c.lineTo(at, strip.y(tick[which]));
      });
      c.strokeStyle = inks[ink];
      c.lineWidth = width * thin;
      c.stroke();
    }));
    swept = newest;
  }

  /// Of what is there only what the marks cover, and covered, is drawn again.
  function drawScene() {
    const canvas = $('scene'), c = canvas.getContext('2d'), outline = state.hidden.outline || [], at = live || {};
    const xs = outline.map(p => p[0]), ys = outline.map(p => p[1]);
    const end = (of, all, sign) => all.length > 0 ? of(...all) + sign * ROUND_M : sign * 2 * ROUND_M;
    const low = [end(Math.min, xs, -1), end(Math.min, ys, -1)], high = [end(Math.max, xs, 1), end(Math.max, ys, 1)];
    const scale = Math.min(canvas.width / (high[0] - low[0]), canvas.height / (high[1] - low[1]));
    const pixel = p => [canvas.width / 2 + scale * (p[0] - (low[0] + high[0]) / 2),
      canvas.height / 2 - scale * (p[1] - (low[1] + high[1]) / 2)];
    const size = 0.375 * rem, hip = is(at.hip) ? pixel(at.hip) : null, go = is(at.go) ? pixel(at.go) : null;
    const tip = hip !== null && is(at.f) && Math.hypot(...at.f) > 0.01
      ? pixel([at.hip[0] + ARROW_M * at.f[0], at.hip[1] + ARROW_M * at.f[1]]) : null;
    function path(points, ink, width) {
      c.beginPath();
      points.forEach(p => c.lineTo(...p));
      c.strokeStyle = inks[ink];
      c.lineWidth = width * rem / 16;
      c.stroke();
    }
    const marks = [hip, go, tip].filter(is);
    c.save();
    if (marked !== null) {
      const all = marks.concat(marked), corner = (of, margin) => [0, 1].map(k => Math.round(of(...all.map(p => p[k])) + margin));
      const [left, top] = corner(Math.min, -2 * size), [right, bottom] = corner(Math.max, 2 * size);
      c.beginPath();
      c.rect(left, top, right - left, bottom - top);
      c.clip();
    }
    marked = marks;
    c.clearRect(0, 0, canvas.width, canvas.height);
    c.lineJoin = 'round';
    if (outline.length > 0) {
      path(outline.concat([outline[0]]).map(pixel), '--text', 2);
      c.fillStyle = inks['--tint'];
      c.fill();
    }
    if (hip && go) path([hip, go], '--edge', 1);
    if (go) {  // a square
      c.fillStyle = inks['--vermillion'];
      c.fillRect(go[0] - size, go[1] - size, 2 * size, 2 * size);
    }
    if (hip) {  // a disc
      c.fillStyle = inks['--blue'];
      c.beginPath();
      c.arc(...hip, size, 0, 7);
      c.fill();
    }
    if (tip) {
      path([hip, tip], '--bad', 3);
      const turn = Math.atan2(tip[1] - hip[1], tip[0] - hip[0]);
      path([-0.5, 0, 0.5].map(side => side === 0 ? tip : [tip[0] - 1.8 * size * Math.cos(turn + side),
        tip[1] - 1.8 * size * Math.sin(turn + side)]), '--bad', 3);
    }
    c.restore();
  }

  /// For this size, in these colours.
  function anew() {
    const style = getComputedStyle(document.documentElement), ratio = window.devicePixelRatio || 1;
    rem = parseFloat(style.fontSize) * ratio;
    ['--text', '--rule', '--tint', '--edge', '--blue', '--vermillion', '--green', '--bad'].forEach(name => {
      inks[name] = style.getPropertyValue(name).trim();
    });
    ['scene', 'strips'].map($).forEach(canvas => {
      canvas.width = Math.round(canvas.clientWidth * ratio);
      canvas.height = Math.round(canvas.clientHeight * ratio);
    });
    swept = marked = null;
    if (shows()) draw();
  }

  // ------------------------------------------------------------------------------------------ what is asked for

  let saidAt = 0;
  function say(ok, text) {
    saidAt = seconds();
    $('said').className = ok ? '' : 'no';
    put($('said'), text);
  }

  async function post(what) {
    const stop = new AbortController(), timer = setTimeout(() => stop.abort(), 3000);
    try {
      const answer = await fetch('/do', { method: 'POST', headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify(what), credentials: 'same-origin', signal: stop.signal });
      const text = await answer.text();
      try {
        return JSON.parse(text);
      } catch (e) {
        return { ok: false, text: 'the server refuses it (' + answer.status + ')' };
      }
    } catch (e) {
      return { ok: false, text: 'no answer; use the chord at the participant\u2019s window' };
    } finally {
      clearTimeout(timer);
    }
  }

  async function act(what) {
    say(true, '\u2026');
    const answer = await post(what);
    say(answer.ok || is(answer.word), is(answer.word) ? '' : answer.text);
    return answer;
  }

  /// Asks in a dialog; the field's text, or null if it was closed otherwise.
  function ask(title, text, label, yes) {
    put($('ask-h'), title);
    fill($('ask-text'), text, () => [].concat(text));
    put($('ask-label'), label || '');
    $('ask-field').hidden = !label;
    $('ask-input').value = '';
    put($('ask-yes'), yes);
    const dialog = $('ask');
    dialog.returnValue = '';
    dialog.showModal();
    (label ? $('ask-input') : $('ask-no')).focus();
    return new Promise(done => {
      dialog.addEventListener('close', () => done(dialog.returnValue === 'yes' ? $('ask-input').value.trim() : null),
        { once: true });
    });
  }

  function on(id, action) {
    $(id).addEventListener('click', () => {
      if (barred(id) === '') return action();
      say(false, barred(id));
    });
  }

  on('stop', async () => {
    const answer = await act({ do: 'stop' });
    if (answer.ok) say(answer.proved, answer.proved ? NO_FORCE : UNPROVED);
  });
  on('pause', () => act({ do: goesOn() ? 'go on' : 'pause' }));
  on('mark', async () => {
    const meant = state.markable;  // what is typed takes a while
    const reason = await ask('Does not count', (is(meant) ? meant.name : 'The running or last trial') + ' is kept, marked, and run again.',
      'Why (kept with it)', 'Does not count');
    if (reason !== null) act({ do: 'mark', reason: reason, trial: is(meant) ? meant.trial_id : null });
  });
  on('end', async () => {
    const first = await act({ do: 'end' });
    if (!first.word) return;
    const word = make('span', first.word);
    word.id = 'ask-word';
    const typed = await ask('End the session', ['What was recorded is kept; the same run command goes on later. To end it, type ',
      word], 'The word', 'End the session');
    filled.delete($('ask-text'));
    if (typed === null) say(true, gone() ? '' : 'The session goes on.');
    else if (typed.toLowerCase() !== first.word.toLowerCase()) say(false, 'that was not the word; the session goes on');
    else if ((await act({ do: 'end', word: first.word })).word) say(false, 'that word is over; press it again');
  });
  on('reveal', async () => {
    const yes = await ask('Show what is felt?', 'From then on whoever sees this page knows object, friction and answers, and could ' +
      'give them away. It is kept in the data, with the time, that it was shown. Other pages stay blind until they ask as well.',
      '', 'Show it');
    if (yes === null) return;
    let answer = { word: '' };
    for (let tries = 0; is(answer.word) && tries < 5; ++tries) answer = await act({ do: 'reveal', word: answer.word });
    if (is(answer.word)) say(false, 'others ask for it at the same time; press it again');
    if (answer.ok) {
      asked = true;
      listen();
      $('felt-h').focus();  // its button is gone
    }
  });
  $('ask-form').addEventListener('submit', () => { $('ask').returnValue = 'yes'; });
  $('ask-yes').value = 'yes';
  $('ask-no').addEventListener('click', () => $('ask').close(''));
  $('ask-stop').addEventListener('click', () => {  // a dialog covers the other one
    $('ask').close('');
    $('stop').click();
  });
  $('note-form').addEventListener('submit', async event => {
    event.preventDefault();
    if (barred('note-send') !== '') say(false, barred('note-send'));
    else if ((await act({ do: 'note', text: $('note').value })).ok) $('note').value = '';
  });
  document.addEventListener('keydown', event => {
    if (event.key === 'Escape' && !event.repeat && (state === null || gone() || state.force.on)) $('stop').click();
  }, true);
  $('aloud').addEventListener('change', () => {
    $('sentence').setAttribute('aria-live', $('aloud').checked ? 'polite' : 'off');
  });

  // ------------------------------------------------------------------------------------------------ the stream

  function heard(event) {
    heardAt = seconds();
    if (lost !== null) {
      lost = null;
      if (event.type === 'live') show();
    }
    return JSON.parse(event.data);
  }

  // A browser has six connections for one address: pages that are hidden let theirs go to one that is looked at.
  const others = new BroadcastChannel('palpate');
  others.addEventListener('message', () => {
    if (!document.hidden || over()) return;
    source.close();
    heardAt = 0;
    lost = null;
    set(document, 'title', 'see the other page \u00b7 palpate');
  });
  function listen() {
    triedAt = seconds();
    if (source !== null) source.close();
    if (!document.hidden) others.postMessage('');
    const words = (asked ? ['shown=1'] : []).concat(document.hidden ? ['still=1'] : []);
    source = new EventSource('/stream' + (words.length > 0 ? '?' + words.join('&') : ''));
    source.addEventListener('state', event => {
      const before = state || {};
      state = heard(event);
      if ((is(before.silent_s) && !is(state.silent_s)) || (before.phase !== state.phase && seconds() - saidAt > SAID_S)) say(true, '');
      if (gone() && $('ask').open) $('ask').close('');  // it would cover why
      stateAt = seconds();
      show();
    });
    source.addEventListener('live', event => {
      live = heard(event);
      if (live.strips) keep(live.strips);
      if (state === null) return;
      if (is(live.force_on) && is(state.force.on) && live.force_on !== state.force.on) {
        state.force = { on: live.force_on, why: '' };
        showForce();
      }
      if (shows() && seconds() - drawnAt > DRAWN_S) draw();
    });
    source.addEventListener('error', () => {
      if (!over()) return lose('The connection broke.');
      source.close();
      clearInterval(timer);
    });
  }
  function lose(why) {
    if (lost !== null || over()) return;
    lost = why;
    $('ask').close('');
    show();
  }

  show();
  listen();
  const timer = setInterval(() => {
    if (heardAt > 0 && seconds() - heardAt > QUIET_S) lose('Nothing came for ' + QUIET_S + ' s.');
    if (lost !== null && seconds() - triedAt > AGAIN_S) listen();
    if (lost !== null) clock();
  }, 200);
  document.addEventListener('visibilitychange', () => {  // who does not look hears of each change, and of nothing else
    if (!over()) listen();
  });
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', anew);
  new ResizeObserver(anew).observe($('shown'));
  new IntersectionObserver(all => {
    seen = all[all.length - 1].isIntersecting;
    if (shows()) draw();
  }).observe($('shown'));
})();
