// Writes package-lock.json without addresses: npm leaves out the registry's (see .npmrc), this
// the sponsors'. Run it as `npm run lock` after a change of package.json.
import { readFileSync, writeFileSync } from "node:fs";

const lock = JSON.parse(readFileSync("package-lock.json", "utf8"));
for (const entry of Object.values(lock.packages)) {
  delete entry.funding;
}
writeFileSync("package-lock.json", `${JSON.stringify(lock, null, 2)}\n`);
