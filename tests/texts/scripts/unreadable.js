(() => {
  const shown = [...document.querySelectorAll('body *')].filter(e => e.checkVisibility());
  const rgb = text => text.match(/[\d.]+/g).map(Number);
  const light = c => c.slice(0, 3).map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = e => {
    const c = rgb(getComputedStyle(e).backgroundColor);
    return c.length < 4 || c[3] > 0 ? c : e === document.documentElement ? [255, 255, 255]
      : behind(e.parentElement);
  };
  const bad = [];
  for (const e of shown) {
    const style = getComputedStyle(e), name = e.tagName + ' ' + e.id + ' ' + e.textContent.slice(0, 30);
    if (style.overflowX !== 'visible' && !e.matches('.unseen, input, section') &&
        e.scrollWidth > e.clientWidth + 1) bad.push('cut off: ' + name);
    const box = e.getBoundingClientRect();
    if (!e.closest('.scroll, .unseen') && box.right > innerWidth + 1) bad.push('too wide: ' + name);
    if (![...e.childNodes].some(n => n.nodeType === 3 && n.data.trim() !== '')) continue;
    const both = [light(rgb(style.color)), light(behind(e))].sort((a, b) => a - b);
    const contrast = (both[1] + 0.05) / (both[0] + 0.05);
    if (contrast < 4.5) bad.push('contrast ' + contrast.toFixed(2) + ': ' + name);
  }
  const boxes = shown.filter(e => e.matches('button') && getComputedStyle(e).position !== 'fixed')
    .map(e => e.getBoundingClientRect());
  boxes.forEach((a, i) => boxes.slice(0, i).forEach(b => {
    if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1) {
      bad.push('buttons that cover each other');
    }
  }));
  for (const y of [0, 1e6]) {
    scrollTo({ top: y, behavior: 'instant' });
    for (const id of ['stop', 'alerts']) {
      const box = document.getElementById(id).getBoundingClientRect();
      if (box.top < -1 || box.bottom > innerHeight + 1) bad.push('out of sight: ' + id);
    }
  }
  return bad.join('\n');
})()
