// The experimenter's page: shows what /stream tells of the running session, and posts what is asked for to /do.
(function () {
  'use strict';
  const QUIET_S = 1.6;   // no event for longer: the stream is lost (there is one a second at least)
  const AGAIN_S = 5;     // a lost stream is asked for again
  const SHOWN_S = 4;     // of the strips
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
  const dark = window.matchMedia('(prefers-color-scheme: dark)');

  let state = null;       // the newest event `state`, and when it came, s
  let stateAt = 0;
  let heardAt = 0;        // any event
  let lost = null;        // why the stream is lost
  let live = null;
  let source = null;
  let triedAt = 0;
  let asked = false;      // this page asked for what is felt

  const seconds = () => performance.now() / 1000;
  const is = value => value !== null && value !== undefined;
  function put(node, text) {
    if (node.textContent !== text) node.textContent = text;
  }
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
    fill(node, rows, () => rows.map(row => {
      const pair = make('div');
      pair.append(make('dt', row[0]), make('dd', row[1], row[2] ? 'bad-word' : ''));
      return pair;
    }));
  }
  const counted = (n, one, more) => n + ' ' + (n === 1 ? one : more || one + 's');
  const ago = ms => ms < 1000 ? Math.round(ms) + ' ms ago' : ms < 120000 ? (ms / 1000).toFixed(1) + ' s ago'
    : Math.round(ms / 60000) + ' min ago';
  const over = () => state !== null && (state.phase === 'ended' || is(state.ended));
  const rests = () => over() && state.ended !== 'killed';
  const gone = () => !rests() && (lost !== null || (state !== null && !state.alive));
  const named = one => (one.practice ? 'Practice ' : 'Trial ') + one.trial;

  // ------------------------------------------------------------------------------------------ what is shown

  function banners() {
    const all = [];
    if (state && is(state.ended)) {
      const said = ENDS[state.ended] || ['The session has ended: ' + state.ended + '.', ''];
      all.push([state.ended === 'killed', said[0], said[1]]);
    } else if (state && !state.alive) {
      all.push([true, ...ENDS.killed]);
    } else if (lost !== null) {
      all.push([true, 'This page has lost the session.', lost + ' What stands below is old. The session may still run: see ' +
        'its window and its terminal; the chords work there.']);
    }
    if (state && !over()) {
      if (state.phase === 'trouble' && state.faults.length > 0) {
        const last = state.faults[state.faults.length - 1];
        all.push([true, 'Trouble: ' + last.cause, last.advice]);
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
    const now = rests() ? 'off' : gone() ? 'unknown' : state.force.on ? 'on' : 'off';
    document.body.dataset.force = now;
    put($('force-word'), now === 'unknown' ? 'Force not known' : 'Force ' + now);
    put($('force-why'), gone() || over() || !state.force.why ? '' : '(' + state.force.why + ')');
  }

  function trialRows() {
    const rows = [
      ['Remaining', counted(state.remaining, 'trial') + (is(state.remaining_min) && state.remaining > 0
        ? ', some ' + Math.max(1, Math.round(state.remaining_min)) + ' min at this pace' : '')],
      ['Next break', is(state.next_break_in) ? 'after ' + counted(state.next_break_in, 'more trial') : 'none'],
      ['Do not count', String(state.not_counting.length)],
      ['Faults', String(state.faults.length)]
    ];
    facts($('trials'), rows);
    $('not-h').hidden = state.not_counting.length === 0;
    $('faults-h').hidden = state.faults.length === 0;
    fill($('not'), state.not_counting, () => state.not_counting.slice().reverse()
      .map(one => make('li', named(one) + ': ' + one.why)));
    fill($('faults'), state.faults, () => state.faults.slice().reverse().map(one => {
      const item = make('li', (is(one.trial) ? named(one) + ': ' : '') + one.cause);
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
      ['Guard', d.guard || none],
      ['Dead-man key', !is(d.dead_man) ? 'not asked for' : d.dead_man ? 'held' : 'not held']
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
    const last = Math.max(...late.session.map((n, i) => n > 0 ? i : 0));
    const tallest = counts => Math.log1p(Math.max(1, ...counts));
    fill($('late-rows'), late, () => names.slice(0, last + 1).map((name, i) => {
      const row = make('tr'), head = make('th', name);
      head.scope = 'row';
      row.append(head);
      [late.trial, late.session].forEach(counts => {
        const cell = make('td'), bar = make('i');
        bar.hidden = !counts[i];
        bar.style.width = 4 * Math.log1p(counts[i] || 0) / tallest(counts) + 'em';
        bar.setAttribute('aria-hidden', 'true');
        cell.append(bar, String(counts[i] || 0));
        row.append(cell);
      });
      return row;
    }));
  }

  function notes() {
    fill($('notes'), state.notes, () => state.notes.slice().reverse().map(note => {
      const item = make('li', note.text), at = new Date(note.at);
      item.append(make('small', (isNaN(at) ? note.at : at.toLocaleTimeString()) +
        (is(note.trial) ? ', ' + named(note).toLowerCase() : '')));
      return item;
    }));
    $('notes').hidden = state.notes.length === 0;
  }

  const goesOn = () => state !== null && (state.phase === 'pause' || state.phase === 'trouble' || state.pausing === true);
  function buttons() {
    const off = state === null || gone() || over() || state.act === false;
    ['stop', 'pause', 'mark', 'end', 'reveal', 'note-send'].forEach(id => {
      $(id).setAttribute('aria-disabled', String(off));
    });
    put($('pause-word'), goesOn() ? 'Go on' : 'Pause');
  }

  function hidden() {
    const shown = state.reveal === 'shown' && is(state.hidden);
    $('shown').hidden = !shown;
    $('covered').hidden = shown;
    $('reveal').hidden = state.reveal !== 'ask' || over();
    if (state.reveal === 'never') {
      put($('blind'), 'Not shown: the protocol says reveal = "never".');
    }
    if (!shown) return;
    const h = state.hidden;
    facts($('hidden'), [['Object', h.object], ['Friction', h.friction], ['Level', is(h.level) ? String(h.level) : null]]);
    fill($('answers'), h.answers, () => h.answers.slice().reverse().map(one => {
      const row = make('tr', null, one.correct === false ? 'wrong' : '');
      [(one.practice ? 'practice ' : '') + one.trial, one.object, one.friction, one.answer, one.correct === true ? 'right' : one.correct === false ? '\u2715 wrong'
        : 'neither'].forEach(text => row.append(make('td', is(text) ? String(text) : '')));
      return row;
    }));
    if (strips === null) buildStrips();
    draw();
  }

  function clock() {
    const since = seconds() - stateAt;
    const runs = state && is(state.phase_s) && !gone() && !over();
    put($('seconds'), runs ? ', ' + (state.phase_s + since).toFixed(1) + ' s' : '');
    if (state) keptRows();
    const late = seconds() - heardAt;
    put($('link'), heardAt === 0 ? 'waiting for the session' : over() ? 'The session is over; this page rests.'
      : gone() ? 'As it was ' + Math.round(late) + ' s ago.'
      : 'In touch with the session.');
  }

  function show() {
    document.body.classList.toggle('gone', gone());
    banners();
    buttons();
    if (!state) return;
    document.body.dataset.phase = state.phase;
    document.body.dataset.kind = state.kind;
    put($('kind'), KINDS[state.kind] || state.kind);
    put($('participant'), state.participant);
    put($('number'), 'session ' + state.number);
    put($('title'), state.title);
    put($('protocol'), state.title === state.protocol ? '' : '(' + state.protocol + ')');
    put($('shape'), SHAPES[state.phase] || '');
    put($('sentence'), (gone() ? 'last heard: ' : '') + state.sentence + (state.practice && !over() && !/practice/.test(state.sentence) ? ' (practice)' : ''));
    const all = state.answered + state.remaining;
    $('bar').max = Math.max(1, all);
    $('bar').value = state.answered;
    put($('left'), state.answered + ' of ' + all + ' answered, ' + state.remaining + ' remain');
    document.title = (gone() ? 'LOST \u00b7 ' : '') + state.participant + ' \u00b7 ' + state.phase + ' \u00b7 palpate';
    showForce();
    trialRows();
    rigRows();
    lateRows();
    notes();
    hidden();
    clock();
  }

  // ---------------------------------------------------------------------------- what is drawn when it is revealed

  let strips = null;
  const ticks = { t: [], fn: [], ft: [], speed: [], mode: [] };
  const MODES = ['free', 'stuck', 'slip'];
  const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  function keep(more) {
    if (more.t.length === 0) return;
    if (ticks.t.length > 0 && more.t[0] < ticks.t[ticks.t.length - 1]) {
      Object.values(ticks).forEach(line => { line.length = 0; });  // another trial
    }
    ticks.t.push(...more.t);
    ticks.fn.push(...more.fn);
    ticks.ft.push(...more.ft);
    ticks.speed.push(...more.speed.map(v => 1000 * v));
    ticks.mode.push(...more.mode.map(word => MODES.indexOf(word)));
    const from = ticks.t.findIndex(t => t >= ticks.t[ticks.t.length - 1] - SHOWN_S);
    Object.values(ticks).forEach(line => line.splice(0, from));
  }

  function buildStrips() {
    if (strips !== null) strips.forEach(plot => plot.destroy());
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize);
    const font = 0.8 * rem + 'px sans-serif', text = colour('--text'), rule = colour('--rule');
    const axis = { stroke: text, font: font, size: 2 * rem, space: 4 * rem, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1 } };
    const line = (label, ink, dash, paths) => ({ label: label, stroke: colour(ink), width: 2, dash: dash, paths: paths,
      points: { show: false } });
    const plot = (title, height, lines, y, scale) => new uPlot({
      title: title, width: Math.max(240, $('strips').clientWidth), height: height * rem, legend: { show: false },
      cursor: { show: false }, scales: { x: { time: false }, y: scale },
      axes: [Object.assign({}, axis, { values: (u, at) => at.map(t => +t.toFixed(2) + ' s') }),
        Object.assign({}, axis, { size: 3.5 * rem, space: 1.8 * rem }, y)],
      series: [{}].concat(lines)
    }, [[]].concat(lines.map(() => [])), $('strips'));
    const atLeast = most => ({ range: { min: { pad: 0.1, soft: 0, mode: 1 }, max: { pad: 0.1, soft: most, mode: 1 } } });
    strips = [
      plot('Force, N: normal solid, friction dashed', 10, [line('normal', '--blue'), line('friction', '--vermillion', [6, 4])], {}, atLeast(1)),
      plot('Speed of the hand, mm/s', 8, [line('speed', '--blue')], {}, atLeast(10)),
      plot('Mode of the contact', 7, [line('mode', '--green', undefined, uPlot.paths.stepped({ align: 1 }))],
        { splits: MODES.map((m, i) => i), values: MODES }, { range: [-0.4, MODES.length - 0.6] })
    ];
  }

  function draw() {
    if (strips === null) return;
    strips[0].setData([ticks.t, ticks.fn, ticks.ft]);
    strips[1].setData([ticks.t, ticks.speed]);
    strips[2].setData([ticks.t, ticks.mode]);
    drawScene();
  }

  function drawScene() {
    const canvas = $('scene'), box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    if (box.width === 0) return;
    canvas.width = Math.round(box.width * ratio);
    canvas.height = Math.round(box.height * ratio);
    const c = canvas.getContext('2d'), outline = state.hidden.outline || [];
    const at = live || {};
    const xs = outline.map(p => p[0]), ys = outline.map(p => p[1]);
    const end = (of, all, sign) => all.length > 0 ? of(...all) + sign * ROUND_M : sign * 2 * ROUND_M;
    const low = [end(Math.min, xs, -1), end(Math.min, ys, -1)], high = [end(Math.max, xs, 1), end(Math.max, ys, 1)];
    const scale = Math.min(canvas.width / (high[0] - low[0]), canvas.height / (high[1] - low[1]));
    const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
    const x = p => canvas.width / 2 + scale * (p[0] - middle[0]), y = p => canvas.height / 2 - scale * (p[1] - middle[1]);
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize) * ratio / 16, size = 6 * rem;
    function path(points, ink, width) {
      c.beginPath();
      points.forEach((p, i) => i === 0 ? c.moveTo(x(p), y(p)) : c.lineTo(x(p), y(p)));
      c.strokeStyle = ink;
      c.lineWidth = width * rem;
      c.stroke();
    }
    c.lineJoin = 'round';
    if (outline.length > 0) {
      path(outline.concat([outline[0]]), colour('--text'), 2);
      c.fillStyle = colour('--tint');
      c.fill();
    }
    if (is(at.hip) && is(at.go)) path([at.hip, at.go], colour('--edge'), 1);
    if (is(at.go)) {  // a square
      c.fillStyle = colour('--vermillion');
      c.fillRect(x(at.go) - size, y(at.go) - size, 2 * size, 2 * size);
    }
    if (is(at.hip)) {  // a disc
      c.fillStyle = colour('--blue');
      c.beginPath();
      c.arc(x(at.hip), y(at.hip), size, 0, 7);
      c.fill();
    }
    const newtons = is(at.f) ? Math.hypot(at.f[0], at.f[1]) : 0;
    if (is(at.hip) && newtons > 0.01) {
      const tip = [at.hip[0] + ARROW_M * at.f[0], at.hip[1] + ARROW_M * at.f[1]];
      path([at.hip, tip], colour('--bad'), 3);
      const turn = Math.atan2(-at.f[1], at.f[0]);
      path([-0.5, 0, 0.5].map(side => side === 0 ? tip : [tip[0] - 1.8 * size * Math.cos(turn + side) / scale,
        tip[1] + 1.8 * size * Math.sin(turn + side) / scale]), colour('--bad'), 3);
    }
    const mm = p => is(p) ? (1000 * p[0]).toFixed(1) + ', ' + (1000 * p[1]).toFixed(1) + ' mm' : 'none';
    put($('scene-text'), 'Disc: hand (HIP) at ' + mm(at.hip) + '. Square: god-object at ' + mm(at.go) +
      '. Arrow: force, ' + newtons.toFixed(2) + ' N; 10 mm is 1 N.');
  }

  // ------------------------------------------------------------------------------------------ what is asked for

  function say(ok, text) {
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
      if ($(id).getAttribute('aria-disabled') !== 'true') return action();
      say(false, state !== null && state.act === false ? 'this page may only look'
        : over() ? 'the session has ended' : 'this page has no session to ask');
    });
  }

  on('stop', async () => {
    if ((await act({ do: 'stop' })).ok) say(true, 'No force any more.');
  });
  on('pause', () => act({ do: goesOn() ? 'go on' : 'pause' }));
  on('mark', async () => {
    const reason = await ask('Does not count', 'The running or last trial is kept, marked, and run again.', 'Why (kept with it)',
      'Does not count');
    if (reason !== null) act({ do: 'mark', reason: reason });
  });
  on('end', async () => {
    const first = await act({ do: 'end' });
    if (!first.word) return;
    const word = make('span', first.word);
    word.id = 'ask-word';
    const typed = await ask('End the session', ['What was recorded is kept; the same run command goes on later. To end it, type ',
      word], 'The word', 'End the session');
    filled.delete($('ask-text'));
    if (typed === null) say(true, 'The session goes on.');
    else if (typed.toLowerCase() !== first.word.toLowerCase()) say(false, 'that was not the word; the session goes on');
    else if ((await act({ do: 'end', word: first.word })).word) say(false, 'that word is over; press it again');
  });
  on('reveal', async () => {
    const yes = await ask('Show what is felt?', 'From then on whoever sees this page knows object, friction and answers, and could ' +
      'give them away. It is kept in the data, with the time, that it was shown. Other pages stay blind until they ask as well.',
      '', 'Show it');
    if (yes === null) return;
    let answer = await act({ do: 'reveal' });
    if (answer.word) answer = await act({ do: 'reveal', word: answer.word });
    if (answer.ok) {
      asked = true;
      listen();
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
    const text = $('note').value.trim();
    if (text === '' || $('note-send').getAttribute('aria-disabled') === 'true') return;
    if ((await act({ do: 'note', text: text })).ok) $('note').value = '';
  });
  document.addEventListener('keydown', event => {
    if (event.key === 'Escape' && !event.repeat && state !== null && state.force.on) $('stop').click();
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

  function listen() {
    triedAt = seconds();
    if (source !== null) source.close();
    source = new EventSource(asked ? '/stream?shown=1' : '/stream');
    source.addEventListener('state', event => {
      state = heard(event);
      stateAt = seconds();
      show();
    });
    let waiting = false;
    source.addEventListener('live', event => {
      live = heard(event);
      if (live.strips) keep(live.strips);
      if (waiting || state === null) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        if (is(live.force_on) && live.force_on !== state.force.on) {
          state.force = { on: live.force_on, why: '' };
          showForce();
        }
        if (state.reveal === 'shown' && is(state.hidden)) draw();
      });
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
    show();
  }

  listen();
  const timer = setInterval(() => {
    if (heardAt > 0 && seconds() - heardAt > QUIET_S) lose('Nothing came for ' + QUIET_S + ' s.');
    if (lost !== null && seconds() - triedAt > AGAIN_S) listen();
    clock();
  }, 200);
  function anew() {
    if (strips !== null) {
      buildStrips();
      draw();
    }
  }
  dark.addEventListener('change', anew);
  window.addEventListener('resize', anew);
})();
