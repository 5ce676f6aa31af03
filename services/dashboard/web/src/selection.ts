// Which vehicle the page is about, and whether the map goes with it.

/** Kept in the address, so that a link opens the same vehicle. */
export function selectedInAddress(): string | null {
  return new URLSearchParams(window.location.hash.slice(1)).get("vehicle");
}

export function putInAddress(vehicleId: string): void {
  window.history.replaceState(null, "", `#${new URLSearchParams({ vehicle: vehicleId })}`);
}

/** The wanted vehicle if it is there, else the first by id, null while there is none. */
export function chooseVehicle(wanted: string | null, vehicleIds: Iterable<string>): string | null {
  const ids = [...vehicleIds].sort();
  return wanted !== null && ids.includes(wanted) ? wanted : (ids[0] ?? null);
}
