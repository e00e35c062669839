// No plots: a page of tables.

start(() => {});
