// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Decodes a LAZ file with npm's laz-perf and prints how many points it has and a sum over their integer coordinates
// that does not depend on their order.

const fs = require('fs');
const { createLazPerf } = require('laz-perf');

(async () => {
  const file = fs.readFileSync(process.argv[2]);
  const perf = await createLazPerf();
  const laszip = new perf.LASZip();
  const data = perf._malloc(file.length);
  perf.HEAPU8.set(file, data);
  laszip.open(data, file.length);
  const count = laszip.getCount(), length = laszip.getPointLength();
  const point = perf._malloc(length);
  let sum = 0;
  for (let i = 0; i < count; ++i) {
    laszip.getPoint(point);
    const view = new DataView(perf.HEAPU8.buffer, point, 12);
    const x = view.getInt32(0, true), y = view.getInt32(4, true), z = view.getInt32(8, true);
    sum += (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) >>> 0;
  }
  console.log(JSON.stringify({ count, sum }));
})();
