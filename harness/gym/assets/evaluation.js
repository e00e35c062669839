// No plots: a page of one table.

start(() => {});
