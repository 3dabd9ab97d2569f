/** Copies text to the clipboard. */

const SHOWN = 1200; // ms for which a button says that it has copied

export async function copyAndSay(button, text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages from a file have no clipboard in some browsers: a hidden field does as well.
    const field = document.createElement("textarea");
    field.value = text;
    document.body.append(field);
    field.select();
    document.execCommand("copy");
    field.remove();
  }
  button.dataset.label ??= button.textContent; // a second click finds "Copied"
  button.textContent = "Copied";
  setTimeout(() => (button.textContent = button.dataset.label), SHOWN);
}
