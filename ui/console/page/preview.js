'use strict';
{
  const $ = id => document.getElementById(id);
  const UNKNOWN = 'hands off the handle, use the switch of the motors';
  const picture = (name, version, words) => {
    const figure = document.createElement('figure');
    const image = document.createElement('img');
    image.src = `/${encodeURIComponent(name)}?v=${version}`;
    image.alt = words;
    const caption = document.createElement('figcaption');
    caption.textContent = words;
    figure.append(image, caption);
    return figure;
  };
  const show = drawn => {
    document.title = `palpate preview: ${drawn.protocol}`;
    $('protocol').textContent = drawn.protocol;
    $('verdict').textContent = drawn.right ? 'it can be run' : 'something stands against it';
    $('verdict').className = drawn.right ? 'right' : 'wrong';
    $('check').textContent = drawn.check;
    $('order').textContent = drawn.order;
    $('screens').replaceChildren(...drawn.screens.map(name =>
      picture(name, drawn.version, name.replace(/\.png$/, '').replaceAll('_', ' '))));
    $('objects').replaceChildren(...(drawn.objects ? [picture(drawn.objects, drawn.version, 'the objects')] : []));
  };
  let said = '';
  const ask = async what => {
    try {
      const answer = await fetch('/do', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(what),
        signal: AbortSignal.timeout(3000) });
      const { ok, text } = await answer.json();
      $('felt-said').textContent = ok ? said : `${said}; not done: ${text}`;
    } catch (e) {
      $('felt-said').textContent = UNKNOWN;
    }
  };
  const feel = felt => {
    $('felt').hidden = false;
    $('felt-said').textContent = said = felt.said || `One stimulus at a time, on ${felt.device}; nothing is kept.`;
    if (String([...$('felt-all').children].map(button => button.textContent)) !== String(felt.stimuli)) {
      $('felt-all').replaceChildren(...felt.stimuli.map((name, at) => {
        const button = document.createElement('button');
        button.type = 'button';
        button.textContent = name;
        button.addEventListener('click', () => ask({ do: 'feel', at }));
        return button;
      }));
    }
    [...$('felt-all').children].forEach((button, at) => button.setAttribute('aria-pressed', String(at === felt.on)));
  };
  $('felt-stop').addEventListener('click', () => ask({ do: 'stop' }));
  document.addEventListener('keydown', event => {
    if (event.key === 'Escape' && !$('felt').hidden) ask({ do: 'stop' });
  });
  const source = new EventSource('/stream');
  let heardAt = performance.now(), lost = false;
  const lose = words => {
    lost = true;
    $('verdict').className = 'wrong';
    $('verdict').textContent = words + ($('felt').hidden ? '' : `: ${UNKNOWN}`);
    $('felt-said').textContent = UNKNOWN;
  };
  for (const [kind, take] of [['felt', feel], ['drawn', show], ['there', () => {}]]) {
    source.addEventListener(kind, event => {
      if (lost) return location.reload();
      heardAt = performance.now();
      take(JSON.parse(event.data));
    });
  }
  source.addEventListener('error', () => lose('palpate preview is gone'));
  setInterval(() => {
    if (!lost && performance.now() - heardAt > 3000) lose('palpate preview does not answer');
  }, 200);
}
