// Nothing but the plots, which plots.js draws.

start(() => {});
