
// Draws the ticks of each figure with uPlot: strips below one another, one cursor and one stretch of time for all.
(function () {
  'use strict';
  var NO_NUMBER = -2147483648;
  var INKS = {
    light: { blue: '#0072b2', vermillion: '#d55e00', green: '#009e73' },
    dark: { blue: '#4fb0ea', vermillion: '#ff8b3d', green: '#2fd0a2' }
  };
  var dark = window.matchMedia('(prefers-color-scheme: dark)');

  // As data/page/html.hpp writes it.
  function numbers(text, count, step) {
    var bytes = atob(text), at = 1, order = bytes.charCodeAt(0);
    var out = new Array(count), last = 0, before = 0, zeros = 0;
    function next() {
      var value = 0, factor = 1, byte;
      do {
        byte = bytes.charCodeAt(at++);
        value += byte % 128 * factor;
        factor *= 128;
      } while (byte > 127);
      return value;
    }
    for (var i = 0; i < count; ++i) {
      var rest = 0;
      if (zeros > 0) {
        --zeros;
      } else {
        rest = next();
        if (rest === 0) zeros = next();
        rest = rest % 2 === 0 ? rest / 2 : -(rest + 1) / 2;
      }
      var value = rest + (order === 0 ? 0 : order === 1 ? last : 2 * last - before);
      before = last;
      last = value;
      out[i] = value === NO_NUMBER ? null : value * step;
    }
    return out;
  }

  function digits(line) {
    return Math.max(0, Math.round(-Math.log10(line.step * line.shown)));
  }

  // Without a minus before zero.
  function fixed(value, digits) {
    return (+value.toFixed(digits) + 0).toFixed(digits);
  }

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  // What is felt as seen from above: border, the hand's last half second, hand, god-object and force at a tick.
  function stage(drawn, times) {
    var lines = drawn.strips[0].lines, x = lines[0].values, y = lines[1].values;
    var played = drawn.played.map(function (line) { return numbers(line.text, drawn.ticks, line.step * line.shown); });
    var modes = drawn.strips.find(function (strip) { return strip.names.length > 0; });
    var box = document.createElement('div'), row = document.createElement('div');
    var play = document.createElement('button'), slider = document.createElement('input');
    var pace = document.createElement('select'), canvas = document.createElement('canvas');
    var words = document.createElement('p');
    var low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    function reach(px, py) {
      low = [Math.min(low[0], px), Math.min(low[1], py)];
      high = [Math.max(high[0], px), Math.max(high[1], py)];
    }
    drawn.border.forEach(function (p) { reach(p[0], p[1]); });
    for (var i = 0; i < drawn.ticks; ++i) if (x[i] !== null && y[i] !== null) reach(x[i], y[i]);
    box.className = 'stage';
    play.type = 'button';
    play.textContent = 'play';
    slider.type = 'range';
    slider.max = drawn.ticks - 1;
    slider.value = 0;
    slider.setAttribute('aria-label', 'time');
    pace.setAttribute('aria-label', 'pace');
    [['real time', 1], ['a quarter', 0.25], ['a twentieth', 0.05]].forEach(function (one) {
      pace.add(new Option(one[0], one[1]));
    });
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'hand, god-object and force at that time, seen from above');
    row.append(play, slider, pace);
    box.append(row, canvas, words);

    var at = 0, timer = 0, follow = null;
    function paint() {
      var ratio = devicePixelRatio, inks = dark.matches ? INKS.dark : INKS.light, c = canvas.getContext('2d');
      canvas.width = canvas.clientWidth * ratio;
      canvas.height = canvas.clientHeight * ratio;
      var scale = 0.9 * Math.min(canvas.width / (high[0] - low[0]), canvas.height / (high[1] - low[1]));
      function path(points, ink, width) {
        c.beginPath();
        points.forEach(function (p) {
          c.lineTo(canvas.width / 2 + scale * (p[0] - (low[0] + high[0]) / 2),
            canvas.height / 2 - scale * (p[1] - (low[1] + high[1]) / 2));
        });
        c.strokeStyle = c.fillStyle = ink;
        c.lineWidth = width * ratio;
        c.stroke();
      }
      function around(p, corners, size) {
        var points = [];
        for (var k = 0; k <= corners; ++k) {
          var turn = (2 * k + 1) * Math.PI / corners;
          points.push([p[0] + size * ratio / scale * Math.cos(turn), p[1] + size * ratio / scale * Math.sin(turn)]);
        }
        return points;
      }
      c.lineJoin = 'round';
      path(drawn.border.concat(drawn.border.slice(0, 1)), colour('--text'), 1.5);
      var trail = [];
      for (var k = at; k >= 0 && times[k] > times[at] - 0.5; --k) if (x[k] !== null) trail.push([x[k], y[k]]);
      path(trail, inks.blue, 1);
      var hip = [x[at], y[at]], go = [played[0][at], played[1][at]], f = [played[2][at], played[3][at]];
      if (go[0] !== null) {
        path([hip, go], colour('--quiet'), 1);
        path(around(go, 4, 6), inks.green, 2);
      }
      var tip = [hip[0] + 10 * f[0], hip[1] + 10 * f[1]], turn = Math.atan2(f[1], f[0]), size = Math.hypot(f[0], f[1]);
      if (size > 0.005) {
        path([hip, tip], inks.vermillion, 2);
        path([-0.5, 0, 0.5].map(function (side) {
          var back = side === 0 ? 0 : 9 * ratio / scale;
          return [tip[0] - back * Math.cos(turn + side), tip[1] - back * Math.sin(turn + side)];
        }), inks.vermillion, 2);
      }
      path(around(hip, 16, 4), inks.blue, 2);
      c.fill();
      function mm(p) { return p[0] === null ? 'none' : fixed(p[0], 1) + ', ' + fixed(p[1], 1) + ' mm'; }
      words.textContent = times[at].toFixed(3) + ' s: disc, the hand at ' + mm(hip) + '; square, god-object ' + mm(go) +
        '; arrow, force ' + size.toFixed(3) + ' N (' +
        (lines.length > 2 ? 'along the plane; ' : '') + '10 mm is 1 N)' +
        (modes ? '; ' + modes.names[modes.lines[0].values[at]] : '') + '.';
    }
    function place(tick) {
      at = Math.max(0, Math.min(drawn.ticks - 1, tick));
      slider.value = at;
      slider.setAttribute('aria-valuetext', times[at].toFixed(3) + ' s');
      paint();
      if (follow) follow(times[at]);
    }
    function stop() {
      cancelAnimationFrame(timer);
      timer = 0;
      play.textContent = 'play';
    }
    function start() {
      var begun = null, from;
      if (at === drawn.ticks - 1) at = 0;
      from = times[at];
      play.textContent = 'stop';
      timer = requestAnimationFrame(function next(now) {
        if (begun === null) begun = now;
        var t = from + pace.value * (now - begun) / 1000, tick = at;
        while (tick < drawn.ticks - 1 && times[tick + 1] <= t) ++tick;
        place(tick);
        if (tick === drawn.ticks - 1) stop();
        else timer = requestAnimationFrame(next);
      });
    }
    play.addEventListener('click', function () {
      if (timer) stop();
      else start();
    });
    pace.addEventListener('change', function () {
      if (!timer) return;
      stop();
      start();
    });
    slider.addEventListener('input', function () {
      stop();
      place(+slider.value);
    });
    return {
      box: box,
      plays: function () { return timer !== 0; },
      place: place,
      again: function () { place(at); },
      tell: function (to) { follow = to; }
    };
  }

  function draw(figure) {
    var drawn = JSON.parse(figure.querySelector('script.ticks').textContent);
    var live = figure.querySelector('.live');
    var times = numbers(drawn.time.text, drawn.ticks, drawn.time.step);
    var begin = times[0], end = times[times.length - 1];
    var least = 20 * (end - begin) / Math.max(1, drawn.ticks - 1);  // of what is shown: 20 ticks
    var shown = { min: begin, max: end };
    drawn.strips.forEach(function (strip) {
      strip.lines.forEach(function (line) {
        line.values = numbers(line.text, drawn.ticks, line.step * line.shown);
      });
    });

    var buttons = document.createElement('div');
    var readout = document.createElement('output');
    var strips = document.createElement('div');
    strips.setAttribute('aria-hidden', 'true');
    readout.setAttribute('role', 'status');
    [['closer', 0.25, 0], ['wider', 1, 0], ['earlier', 0.5, -0.5], ['later', 0.5, 0.5], ['all', 1e9, 0]]
      .forEach(function (one) {
        var button = document.createElement('button');
        button.type = 'button';
        button.textContent = one[0];
        button.addEventListener('click', function () {
          var half = one[1] * (shown.max - shown.min);
          var middle = (shown.min + shown.max) / 2 + one[2] * (shown.max - shown.min);
          show(middle - half, middle + half);
        });
        buttons.appendChild(button);
      });
    var played = stage(drawn, times);
    live.append(buttons, readout, played.box, strips);
    live.hidden = false;
    figure.classList.add('drawn');

    var plots = [], busy = false;
    function show(min, max) {
      var width = Math.min(Math.max(max - min, least), end - begin);
      min = Math.max(begin, Math.min((min + max - width) / 2, end - width));
      shown = { min: min, max: min + width };
      busy = true;
      plots.forEach(function (plot) { plot.setScale('x', shown); });
      busy = false;
      say();
      requestAnimationFrame(played.again);
    }
    played.tell(function (time) {
      if (played.plays() && time > shown.max) {
        show(time, time + shown.max - shown.min);
        return;
      }
      plots.forEach(function (plot) {
        plot.setCursor({ left: plot.valToPos(time, 'x'), top: plot.over.clientHeight / 2 }, false);
      });
    });
    function say() {
      var first = times.findIndex(function (t) { return t >= shown.min; });
      var last = times.length - 1;
      while (last > 0 && times[last] > shown.max) --last;
      var parts = [];
      drawn.strips.forEach(function (strip) {
        strip.lines.forEach(function (line) {
          if (strip.names.length > 0) return;
          var low = null, high = null;
          for (var i = Math.max(first, 0); i <= last; ++i) {
            var value = line.values[i];
            if (value === null) continue;
            if (low === null || value < low) low = value;
            if (high === null || value > high) high = value;
          }
          if (low !== null) {
            parts.push(line.label + ' ' + fixed(low, digits(line)) + ' to ' + fixed(high, digits(line)) + ' ' +
              line.unit);
          }
        });
      });
      readout.textContent = shown.min.toFixed(3) + ' s to ' + shown.max.toFixed(3) + ' s, ' +
        Math.max(0, last - Math.max(first, 0) + 1) + ' ticks: ' + parts.join('; ');
    }

    function vertical(plot, at, text, ink) {
      if (at < plot.scales.x.min || at > plot.scales.x.max) return;
      var c = plot.ctx, x = plot.valToPos(at, 'x', true), box = plot.bbox;
      c.save();
      c.strokeStyle = c.fillStyle = ink;
      c.lineWidth = devicePixelRatio;
      c.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
      c.beginPath();
      c.moveTo(x, box.top);
      c.lineTo(x, box.top + box.height);
      c.stroke();
      c.font = 11 * devicePixelRatio + 'px sans-serif';
      c.textAlign = x > box.left + box.width / 2 ? 'right' : 'left';
      c.textBaseline = 'top';
      c.fillText(text, x + (c.textAlign === 'left' ? 4 : -4) * devicePixelRatio, box.top + 2);
      c.restore();
    }
    function triangles(plot, ink) {
      var c = plot.ctx, box = plot.bbox, size = 4 * devicePixelRatio, foot = box.top + box.height;
      c.save();
      c.fillStyle = ink;
      drawn.sticks.forEach(function (at) {
        if (at < plot.scales.x.min || at > plot.scales.x.max) return;
        var x = plot.valToPos(at, 'x', true);
        c.beginPath();
        c.moveTo(x, foot - 2 * size);
        c.lineTo(x - size, foot);
        c.lineTo(x + size, foot);
        c.fill();
      });
      c.restore();
    }

    function build() {
      plots.forEach(function (plot) { plot.destroy(); });
      var inks = dark.matches ? INKS.dark : INKS.light;
      var text = colour('--text'), rule = colour('--rule');
      var font = '11px sans-serif';
      plots = drawn.strips.map(function (strip, place) {
        var words = strip.names;
        var unit = strip.lines[0].unit;
        var options = {
          title: strip.title + (unit ? ', ' + unit : ''),
          width: Math.max(280, live.clientWidth),
          height: strip.height,
          cursor: { y: false, sync: { key: figure.id, setSeries: false }, drag: { x: true, y: false } },
          scales: { x: { time: false }, y: words.length ? { range: [-0.4, words.length - 0.6] } : {} },
          axes: [
            { stroke: text, font: font, size: 28, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1 },
              values: function (plot, at) { return at.map(function (t) { return +t.toFixed(6) + ' s'; }); } },
            { stroke: text, font: font, size: 74, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1 } }
          ],
          series: [{ label: 'time', value: function (plot, t) { return t === null ? '\u2013' : t.toFixed(3) + ' s'; } }],
          hooks: {
            setScale: [function (plot, key) {
              if (key === 'x' && !busy && plots.length === drawn.strips.length) {
                show(plot.scales.x.min, plot.scales.x.max);
              }
            }],
            draw: [function (plot) {
              drawn.marks.forEach(function (mark) {
                vertical(plot, Math.min(mark.at, end), place === 0 ? mark.text : '', mark.fault ? inks.vermillion : text);
              });
              if (place === 1) triangles(plot, inks.green);
            }]
          }
        };
        if (words.length) {
          options.axes[1].splits = words.map(function (word, i) { return i; });
          options.axes[1].values = words;
        }
        strip.lines.forEach(function (line) {
          options.series.push({
            label: line.label,
            stroke: inks[line.ink],
            width: 1,
            dash: line.dash ? [line.dash, line.dash === 6 ? 4 : 3] : undefined,
            points: { show: false },
            paths: words.length ? uPlot.paths.stepped({ align: 1 }) : undefined,
            value: function (plot, value) {
              return value === null || value === undefined ? '\u2013'
                : words.length ? words[value] : fixed(value, digits(line)) + ' ' + line.unit;
            }
          });
        });
        var data = [times].concat(strip.lines.map(function (line) { return line.values; }));
        var plot = new uPlot(options, data, strips);
        plot.over.addEventListener('mousemove', function (event) {
          if (!played.plays()) played.place(plot.posToIdx(event.offsetX));
        });
        plot.over.addEventListener('mouseleave', function () { requestAnimationFrame(played.again); });
        return plot;
      });
      show(shown.min, shown.max);
    }
    build();
    dark.addEventListener('change', build);
    window.addEventListener('resize', function () {
      plots.forEach(function (plot, i) {
        plot.setSize({ width: Math.max(280, live.clientWidth), height: drawn.strips[i].height });
      });
      requestAnimationFrame(played.again);
    });
  }

  document.querySelectorAll('script.ticks').forEach(function (ticks) { draw(ticks.closest('figure')); });
})();
