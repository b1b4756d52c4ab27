
// Draws the ticks of each figure with uPlot: strips below one another, one cursor and one stretch of time for all.
(function () {
  'use strict';
  var NO_NUMBER = -2147483648;
  var INKS = {
    light: { blue: '#0072b2', vermillion: '#d55e00', green: '#009e73' },
    dark: { blue: '#4fb0ea', vermillion: '#ff8b3d', green: '#2fd0a2' }
  };
  var dark = window.matchMedia('(prefers-color-scheme: dark)');

  // As data/page/tick_text.hpp writes it.
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

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  function draw(figure) {
    var drawn = JSON.parse(figure.querySelector('script.ticks').textContent);
    var live = figure.querySelector('.live');
    var times = numbers(drawn.time.text, drawn.ticks, drawn.time.step);
    var begin = times[0], end = times[times.length - 1];
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
    live.append(buttons, readout, strips);
    live.hidden = false;
    figure.classList.add('drawn');

    var plots = [], busy = false;
    function show(min, max) {
      var width = Math.min(max - min, end - begin);
      min = Math.max(begin, Math.min(min, end - width));
      shown = { min: min, max: min + width };
      busy = true;
      plots.forEach(function (plot) { plot.setScale('x', shown); });
      busy = false;
      say();
    }
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
            parts.push(line.label + ' ' + low.toFixed(digits(line)) + ' to ' + high.toFixed(digits(line)) + ' ' +
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
          cursor: { sync: { key: figure.id, setSeries: false }, drag: { x: true, y: false } },
          scales: { x: { time: false }, y: words.length ? { range: [-0.4, words.length - 0.6] } : {} },
          axes: [
            { stroke: text, font: font, size: 28, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1 },
              values: function (plot, at) { return at.map(function (t) { return +t.toFixed(6) + ' s'; }); } },
            { stroke: text, font: font, size: 60, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1 } }
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
                : words.length ? words[value] : value.toFixed(digits(line)) + ' ' + line.unit;
            }
          });
        });
        var data = [times].concat(strip.lines.map(function (line) { return line.values; }));
        return new uPlot(options, data, strips);
      });
      show(shown.min, shown.max);
    }
    build();
    dark.addEventListener('change', build);
    window.addEventListener('resize', function () {
      plots.forEach(function (plot, i) {
        plot.setSize({ width: Math.max(280, live.clientWidth), height: drawn.strips[i].height });
      });
    });
  }

  document.querySelectorAll('script.ticks').forEach(function (ticks) { draw(ticks.closest('figure')); });
})();
