// The plots of a page: those over time share `overTime`, the group that they zoom with. Returns all groups.
function drawCharts(overTime) {
  const groups = [overTime];
  for (const chart of data.charts) {
    const group = chart.across[0] === "time" ? overTime : makeGroup(() => {}, chart.logarithmicAcross);
    if (group !== overTime) groups.push(group);
    const parent = create("div", element("plots"), chart.rows.some((row) => row.length > 1) ? "chart broad" : "chart");
    create("h3", parent, "", chart.title);
    for (const row of chart.rows) {
      const line = create("div", parent, "row");
      for (const panel of row) new Plot(create("div", line, "panel"), panel, chart.across, group);
    }
  }
  return groups;
}
