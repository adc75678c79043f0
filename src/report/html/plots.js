// Draws every plot once it comes near the window, in the colours of the page.
(() => {
  "use strict";
  const plots = [...document.querySelectorAll(".plot")];
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const touch = matchMedia("(pointer: coarse)").matches;
  const drawn = new Set();

  // Colours are written as names of the style sheet's variables.
  const coloured = (value, style) => {
    if (typeof value === "string") {
      return value.startsWith("--") ? style.getPropertyValue(value).trim() : value;
    }
    if (Array.isArray(value)) {
      return value.length && typeof value[0] === "object" && value[0] !== null
        ? value.map(v => coloured(v, style)) : value;
    }
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, coloured(v, style)]));
  };

  // Plots of one group show the same stretch of their horizontal axis: the one somebody looked closer at.
  const stretches = {};
  let following = false;
  const follow = (plot, change) => {
    const from = change["xaxis.range[0]"] ?? change["xaxis.range"]?.[0];
    const to = change["xaxis.range[1]"] ?? change["xaxis.range"]?.[1];
    if (following || from === undefined) return;
    stretches[plot.dataset.group] = [from, to];
    following = true;
    const others = [...drawn].filter(p => p !== plot && p.dataset.group === plot.dataset.group);
    Promise.all(others.map(p => Plotly.relayout(p.querySelector("div"), { "xaxis.range": [from, to] })))
      .finally(() => { following = false; });
  };

  // On paper nothing is fitted to its place afterwards: plots get their size when they are drawn.
  const draw = (plot, onPaper) => {
    const style = getComputedStyle(document.documentElement);
    const { data, layout, config } =
      coloured(JSON.parse(plot.querySelector("script").textContent), style);
    if (touch) layout.dragmode = false;
    const target = plot.querySelector("div");
    const stretch = stretches[plot.dataset.group];
    if (stretch) layout.xaxis.range = stretch;
    if (onPaper) [layout.width, layout.height] = [target.clientWidth, target.clientHeight];
    Plotly.newPlot(target, data, layout, config);
    target.removeAllListeners("plotly_relayout");
    if (plot.dataset.group) target.on("plotly_relayout", change => follow(plot, change));
    drawn.add(plot);
  };
  const redraw = () => drawn.forEach(plot => draw(plot, false));

  const near = new IntersectionObserver(entries => {
    for (const { isIntersecting, target } of entries) {
      if (isIntersecting && !drawn.has(target)) draw(target, false);
    }
  }, { rootMargin: "600px" });
  plots.forEach(plot => near.observe(plot));
  // The others follow one by one, whether somebody scrolls or not: a browser without a window tells of no
  // plot that comes near.
  const rest = () => {
    const next = plots.find(plot => !drawn.has(plot) && plot.offsetParent);
    if (!next) return;
    draw(next, false);
    setTimeout(rest, 50);
  };
  setTimeout(rest, 500);
  dark.addEventListener("change", redraw);

  // Paper is white and has everything on it.
  addEventListener("beforeprint", () => {
    document.documentElement.dataset.theme = "paper";
    document.querySelectorAll("details").forEach(d => { d.open = true; });
    plots.forEach(plot => draw(plot, true));
  });
  addEventListener("afterprint", () => {
    delete document.documentElement.dataset.theme;
    redraw();
  });
})();
