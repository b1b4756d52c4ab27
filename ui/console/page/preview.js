'use strict';
{
  const $ = id => document.getElementById(id);
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
  const source = new EventSource('/stream');
  source.addEventListener('drawn', event => show(JSON.parse(event.data)));
  source.addEventListener('error', () => { $('verdict').textContent = 'palpate preview is gone'; });
}
