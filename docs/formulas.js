// SPDX-License-Identifier: BSD-3-Clause
// Typesets the formulas that pymdownx.arithmatex has marked: \(...\) in a <span>, \[...\] in a
// <div>.
document.addEventListener("DOMContentLoaded", () => {
  for (const formula of document.querySelectorAll(".arithmatex")) {
    const source = formula.textContent.trim().slice(2, -2);
    katex.render(source, formula, {displayMode: formula.tagName === "DIV", throwOnError: false});
  }
});
