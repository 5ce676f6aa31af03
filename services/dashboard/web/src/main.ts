// Puts the page together: the line feeds the fleet, the fleet feeds the map and the panel.

import "maplibre-gl/dist/maplibre-gl.css";
import { html, render } from "lit-html";
import type { TemplateResult } from "lit-html";

import { forgetToken, saveToken, savedToken } from "./access";
import { ServerClock, vehicleNowMs } from "./clock";
import type { Now } from "./clock";
import { Connection } from "./connection";
import type { LineState } from "./connection";
import { applyView, emptyFleet, nameRoute } from "./fleet";
import type { Fleet, Vehicle } from "./fleet";
import { goneBus } from "./health";
import { FleetMap } from "./map/map";
import { mapTools } from "./map/tools";
import { accessForm } from "./panels/access";
import { arrivalsPanel } from "./panels/arrivals";
import { banner, busBanner } from "./panels/banner";
import { pastPanel } from "./panels/past";
import { positioningPanel } from "./panels/positioning";
import { servicesPanel } from "./panels/services";
import { slopePanel } from "./panels/slope";
import { vehiclePanel } from "./panels/vehicle";
import { vehicleList } from "./panels/vehicles";
import { EarlierTrail } from "./past/earlier";
import { Past } from "./past/past";
import { chooseVehicle, putInAddress, selectedInAddress } from "./selection";
import type { Service } from "./view";

/** Text that changes faster is not read; the map moves with every pose. */
const PANEL_PERIOD_MS = 250;

function element(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (found === null) {
    throw new Error(`no element ${id} in index.html`);
  }
  return found;
}

const places = {
  panel: element("panel"),
  banner: element("banner"),
  tools: element("map-tools"),
  access: element("access"),
};
const fleet = emptyFleet();
const clock = new ServerClock(() => performance.now());
let line: LineState = { kind: "connecting" };
let wasOpen = false;
let wanted = selectedInAddress();

const map = new FleetMap(element("map"), () => renderTools());
const past = new Past(() => {
  showOnMap();
  renderPage();
});
const earlier = new EarlierTrail(() => showOnMap());
const connection = new Connection({
  onState(state) {
    line = state;
    wasOpen ||= state.kind === "open";
    renderPage();
  },
  onView(view) {
    const known = fleet.selected;
    applyView(fleet, view, clock.set(view.now));
    connection.select(selected());
    showOnMap();
    if (view.kind === "snapshot" || fleet.selected !== known) {
      renderPage();
    }
  },
  onRoute(route) {
    nameRoute(fleet, route);
    map.addRoute(route);
  },
});

function selected(): string | null {
  return chooseVehicle(wanted, fleet.vehicles.keys());
}

function choose(vehicleId: string): void {
  wanted = vehicleId;
  putInAddress(vehicleId);
  connection.select(vehicleId);
  past.close();
  showOnMap();
  map.setFollowing(true);
  renderPage();
}

/** The present with what history kept of the trail, or the past. */
function showOnMap(): void {
  const vehicle = fleet.vehicles.get(selected() ?? "");
  const isPresent = past.vehicleId === null && vehicle !== undefined && hasHistory();
  map.show(isPresent ? withVehicle(fleet, earlier.before(vehicle)) : past.shown(fleet), selected());
}

function withVehicle(known: Fleet, vehicle: Vehicle): Fleet {
  return { ...known, vehicles: new Map(known.vehicles).set(vehicle.vehicle_id, vehicle) };
}

function hasHistory(): boolean {
  return services().some(({ service, up }) => service === "history" && up);
}

function enter(token: string): void {
  saveToken(token);
  void connection.open();
}

function renderTools(): void {
  const actions = {
    follow: () => map.setFollowing(!map.following),
    overview: () => map.overview(),
  };
  render(mapTools(map.following, actions), places.tools);
}

/** The vehicle's own services, then the fleet's. */
function services(): Service[] {
  return [...(fleet.vehicles.get(selected() ?? "")?.services ?? []), ...fleet.services];
}

function renderPanel(): void {
  const now = clock.now();
  const vehicle = fleet.vehicles.get(selected() ?? "");
  const isBusThere = goneBus(services()) === null;
  const isLive = line.kind === "open" && isBusThere;
  const isPast = past.vehicleId !== null;
  const parts =
    vehicle === undefined
      ? html`<p class="empty">${wasOpen ? "No vehicle has been heard yet." : "Connecting…"}</p>`
      : past.vehicleId === vehicle.vehicle_id
        ? pastPanel(vehicle.vehicle_id, past, vehicleNowMs(vehicle, now))
        : html`${vehiclePanel(vehicle, now)} ${details(vehicle, now)}`;
  render(
    html`
      <header>
        <h1>Wayline</h1>
        <span class="line-state ${isPast ? "past" : isLive ? "open" : "closed"}"
          >${isPast ? "past" : isLive ? "live" : "not live"}</span
        >
      </header>
      ${vehicleList(fleet.vehicles.values(), selected(), now, choose)} ${parts}
      ${servicesPanel(services(), isBusThere, now)}
    `,
    places.panel,
  );
}

/** What is told of the selected vehicle only: it comes a moment after the selection. */
function details(vehicle: Vehicle, now: Now): TemplateResult | null {
  if (vehicle.vehicle_id === fleet.selected) {
    return html`
      ${arrivalsPanel(vehicle, now, fleet.routeNames)} ${slopePanel(vehicle)}
      ${positioningPanel(vehicle)}
      ${hasHistory() ? pastPanel(vehicle.vehicle_id, past, vehicleNowMs(vehicle, now)) : null}
    `;
  }
  return line.kind === "open" ? null : html`<p class="empty">More comes with the connection.</p>`;
}

function renderBanner(): void {
  const tryNow = (): void => connection.tryNow();
  const gone = line.kind === "open" ? goneBus(services()) : null;
  const said =
    gone === null
      ? banner(line, wasOpen, performance.now(), tryNow)
      : busBanner(gone, clock.now());
  render(said, places.banner);
}

function renderAccess(): void {
  const isRefused = line.kind === "refused";
  const triedBefore = isRefused && savedToken() !== null;
  if (isRefused) {
    forgetToken();
  }
  render(isRefused ? accessForm(triedBefore, enter) : null, places.access);
  document.body.classList.toggle("locked", isRefused);
}

function renderPage(): void {
  document.body.classList.toggle("old", wasOpen && line.kind !== "open");
  renderPanel();
  renderBanner();
  renderAccess();
}

declare global {
  interface Window {
    /** What the browser tests look at. */
    wayline: { map: FleetMap["map"]; fleet: typeof fleet };
  }
}
window.wayline = { map: map.map, fleet };

renderTools();
renderPage();
window.setInterval(() => {
  renderPanel();
  renderBanner();
}, PANEL_PERIOD_MS);
connection.select(wanted);
void connection.open();
