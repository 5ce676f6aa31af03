import { expect, test } from "vitest";

import { protocols } from "../src/access";
import { waitMs } from "../src/backoff";
import { chooseVehicle } from "../src/selection";

test("waiting doubles up to ten seconds", () => {
  expect([1, 2, 3, 5, 50].map((failures) => waitMs(failures, 0.5))).toEqual([
    500, 1000, 2000, 8000, 10_000,
  ]);
});

test("many pages do not come back at once", () => {
  expect(waitMs(3, 0)).toBeLessThan(waitMs(3, 0.9));
});

test("a token travels as base64url without padding", () => {
  expect(protocols("a?>~")).toEqual(["wayline.v1", "wayline.bearer.YT8-fg"]);
  expect(protocols(null)).toEqual(["wayline.v1"]);
});

test("the wanted vehicle is kept while it is there", () => {
  expect(chooseVehicle("b", ["b", "a"])).toBe("b");
  expect(chooseVehicle("z", ["b", "a"])).toBe("a");
  expect(chooseVehicle("z", [])).toBeNull();
});
