/** Gives `parent` a span with text and style for each item. Spans that are there stay, so that frames are cheap. */
export function spans(parent, items) {
  while (parent.childElementCount > items.length) parent.lastElementChild.remove();
  while (parent.childElementCount < items.length) parent.append(document.createElement('span'));
  for (const [i, { text, style }] of items.entries()) {
    const span = parent.children[i];
    if (span.textContent !== text) span.textContent = text;
    Object.assign(span.style, { left: '', right: '', ...style });
  }
}
