/* Films play while they are in view, unless their reader wants less motion. */
addEventListener("DOMContentLoaded", () => {
  if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  const watch = new IntersectionObserver((films) => {
    for (const { target, isIntersecting } of films) {
      if (isIntersecting) target.play().catch(() => {});
      else target.pause();
    }
  });
  for (const film of document.querySelectorAll("video.film")) watch.observe(film);
});
