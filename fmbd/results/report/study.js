// The page of a study: plots alone.
const overTime = makeGroup(() => {});
const groups = drawCharts(overTime);
function drawAll() { for (const group of groups) group.draw(); }
window.addEventListener("resize", drawAll);
drawAll();
