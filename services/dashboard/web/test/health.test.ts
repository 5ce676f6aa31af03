import { describe, expect, test } from "vitest";

import { goneBus, servicesInWords, serviceTone } from "../src/health";
import type { Service } from "../src/view";
import { since } from "../src/words";

const ROUTER = { subject: "router", what: "the bus is gone", since: "2026-11-30T12:00:00.000Z" };
const INPUT = { subject: "input", what: "nothing is heard of pose", since: ROUTER.since };

function service(name: string, changes: Partial<Service> = {}): Service {
  return {
    service: name,
    up: true,
    t: null,
    version: null,
    in_rate_hz: null,
    out_rate_hz: null,
    backlog: 0,
    dropped: 0,
    dropped_rate_hz: 0,
    bad_input: 0,
    bad_input_rate_hz: 0,
    lag_ms_p50: null,
    lag_ms_p99: null,
    detail: null,
    missing: [],
    recorded: false,
    ...changes,
  };
}

describe("services in words", () => {
  test.each<[string, Partial<Service>, string]>([
    ["well", {}, "all up"],
    ["down", { up: false }, "1 down"],
    ["without input", { missing: [INPUT] }, "1 not ready"],
    ["down, whatever it lacked", { up: false, missing: [INPUT] }, "1 down"],
  ])("%s", (_, changes, words) => {
    expect(servicesInWords([service("fusion"), service("eta", changes)], true)).toBe(words);
  });

  test("without the bus nobody is called down", () => {
    const all = [service("eta", { up: false }), service("dashboard", { missing: [ROUTER] })];
    expect(goneBus(all)).toBe(ROUTER);
    expect(servicesInWords(all, false)).toBe("not known");
    expect(all.map((each) => serviceTone(each, false))).toEqual(["off", "off"]);
  });

  test("that another service hears no router says nothing of the page's own bus", () => {
    expect(goneBus([service("eta", { missing: [ROUTER] }), service("dashboard")])).toBeNull();
  });
});

describe("a lamp", () => {
  test.each<[string, Partial<Service>, string]>([
    ["is green where all is well", {}, "good"],
    ["keeps no scar of drops long ago", { dropped: 700 }, "good"],
    ["warns of drops now", { dropped: 700, dropped_rate_hz: 12 }, "warn"],
    ["warns where something is missing", { missing: [INPUT] }, "warn"],
    ["is red where the service is down", { up: false }, "bad"],
  ])("%s", (_, changes, tone) => {
    expect(serviceTone(service("eta", changes), true)).toBe(tone);
  });
});

test("since when is a time of day with its duration, later a date", () => {
  const from = Date.parse(ROUTER.since);
  expect(since(from, from + 300_000)).toMatch(/^since \d+:00.* \(5 min\)$/);
  expect(since(from, from + 3 * 86_400_000)).toMatch(/^since .*2026.* \(3 d\)$/);
  expect(since(from, from - 5_000)).toContain("(less than 1 s)");
});
