// Copies the parameter files; plots.js, which comes first, draws.

/** Copies a text, or selects it where the browser gives a page no clipboard. */
async function copy(button) {
  const source = document.getElementById(button.dataset.copies);
  try {
    await navigator.clipboard.writeText(source.textContent);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(source);
    button.textContent = "Selected";
  }
}

start(() => {
  for (const button of document.querySelectorAll("button[data-copies]")) {
    button.onclick = () => copy(button);
  }
});
