// Runs the packed program of a page that holds all that it needs.
(async () => {
  const note = document.getElementById('note');
  if (typeof DecompressionStream === 'undefined') {
    note.textContent = 'This browser is too old for this page: it lacks DecompressionStream.';
    return;
  }
  const packed = Uint8Array.from(atob(document.getElementById('program').textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const script = document.createElement('script');
  script.textContent = await new Response(stream).text();
  document.body.append(script);
})();
