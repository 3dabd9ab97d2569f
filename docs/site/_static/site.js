addEventListener("DOMContentLoaded", () => {
  // Films play while they are in view, unless their reader wants less motion.
  const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const watch = new IntersectionObserver((films) => {
    for (const { target, isIntersecting } of films) {
      if (isIntersecting && !isStill) target.play().catch(() => {});
      else target.pause();
    }
  });
  for (const film of document.querySelectorAll("video.film")) watch.observe(film);

  // What scrolls by itself can be reached by keys; what folds has a name.
  for (const part of document.querySelectorAll(".bd-article :is(table, pre, .math)"))
    if (part.scrollWidth > part.clientWidth) part.tabIndex = 0;
  for (const fold of document.querySelectorAll("summary:has(.toctree-toggle)"))
    fold.setAttribute("aria-label", "The pages below");
});
