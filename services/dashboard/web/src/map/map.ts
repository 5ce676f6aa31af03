// The map: holds MapLibre, redraws what changed, follows a vehicle.

import {
  LngLatBounds,
  Map as MapLibreMap,
  NavigationControl,
  ScaleControl,
  setWorkerUrl,
} from "maplibre-gl";
import type { GeoJSONSource } from "maplibre-gl";
import workerUrl from "maplibre-gl/dist/maplibre-gl-worker.mjs?url";

import type { Fleet, Vehicle } from "../fleet";
import type { TrailPoint } from "../view";
import {
  ellipseFeatures,
  fixFeatures,
  gridFeatures,
  position,
  routeFeatures,
  trailFeatures,
  vehicleFeatures,
} from "./features";
import { addIcons } from "./icons";
import { mapStyle } from "./style";
import type { SourceName } from "./style";
import { DARK, LIGHT } from "./theme";

const STREET_ZOOM = 16.4;
const GRID_SPACING_PX = 150;
/** Slightly more than the time between poses, so that the map glides. */
const GLIDE_MS = 130;
const NO_TRAIL: readonly TrailPoint[] = [];

setWorkerUrl(workerUrl);

export class FleetMap {
  readonly map: MapLibreMap;
  /** Whether the map keeps the selected vehicle in its middle. */
  following = true;

  private readonly routes: GeoJSON.FeatureCollection[] = [];
  private fleet: Fleet | undefined;
  private selected: string | null = null;
  private ready = false;
  private placed = false;
  private trailDrawn: readonly TrailPoint[] | undefined;
  private readonly dark = window.matchMedia("(prefers-color-scheme: dark)");
  private readonly still = window.matchMedia("(prefers-reduced-motion: reduce)");

  constructor(
    container: HTMLElement,
    private readonly onFollowing: () => void,
  ) {
    this.map = new MapLibreMap({
      container,
      style: mapStyle(this.theme()),
      center: [0, 20],
      zoom: 1,
      attributionControl: false,
      pitchWithRotate: false,
      fadeDuration: 0,
    });
    this.map.addControl(new NavigationControl({ visualizePitch: false }), "bottom-right");
    this.map.addControl(new ScaleControl({ maxWidth: 140 }), "bottom-left");
    this.map.on("style.load", () => this.drawAll());
    this.map.on("moveend", () => this.drawGrid());
    this.map.on("dragstart", () => this.setFollowing(false));
    this.dark.addEventListener("change", () => {
      this.ready = false;
      this.map.setStyle(mapStyle(this.theme()), { diff: false });
    });
  }

  /** Draws the fleet with one vehicle selected. */
  show(fleet: Fleet, selected: string | null): void {
    if (selected !== this.selected) {
      this.placed = false;
    }
    this.fleet = fleet;
    this.selected = selected;
    this.draw();
    this.keepInView();
  }

  addRoute(route: GeoJSON.FeatureCollection): void {
    this.routes.push(route);
    this.drawRoutes();
    this.overviewUnplaced();
  }

  setFollowing(following: boolean): void {
    this.following = following;
    this.onFollowing();
    this.placed = false;
    this.keepInView();
  }

  /** Shows all vehicles, trails and routes at once. */
  overview(): void {
    this.setFollowing(false);
    this.fitAll(true);
  }

  private theme(): typeof LIGHT {
    return this.dark.matches ? DARK : LIGHT;
  }

  private vehicle(): Vehicle | undefined {
    return this.selected === null ? undefined : this.fleet?.vehicles.get(this.selected);
  }

  private drawAll(): void {
    this.ready = true;
    addIcons(this.map, this.theme());
    this.trailDrawn = undefined;
    this.drawRoutes();
    this.drawGrid();
    this.draw();
  }

  private draw(): void {
    if (!this.ready || this.fleet === undefined) {
      return;
    }
    const vehicle = this.vehicle();
    this.setData("vehicles", vehicleFeatures(this.fleet.vehicles.values(), this.selected));
    this.setData("ellipse", ellipseFeatures(vehicle));
    this.setData("fix", fixFeatures(vehicle));
    const trail = vehicle?.trail ?? NO_TRAIL;
    if (trail !== this.trailDrawn) {
      this.setData("trail", trailFeatures(trail));
      this.trailDrawn = trail;
    }
  }

  private drawRoutes(): void {
    if (this.ready) {
      this.setData("routes", routeFeatures(this.routes, "LineString"));
      this.setData("stops", routeFeatures(this.routes, "Point"));
    }
  }

  private drawGrid(): void {
    if (!this.ready) {
      return;
    }
    // drawn wider than seen, so that a moving map has its grid before it comes to rest
    const bounds = this.map.getBounds();
    const [west, south, east, north] = bounds.toArray().flat() as [number, number, number, number];
    const [beside, above] = [(east - west) / 2, (north - south) / 2];
    const wanted = (2 * this.map.getContainer().clientWidth) / GRID_SPACING_PX;
    this.setData(
      "grid",
      gridFeatures([west - beside, south - above, east + beside, north + above], wanted),
    );
  }

  private setData(name: SourceName, data: GeoJSON.FeatureCollection): void {
    void this.map.getSource<GeoJSONSource>(name)?.setData(data);
  }

  private keepInView(): void {
    const center = position(this.vehicle());
    if (center === null) {
      return;
    }
    if (!this.placed) {
      this.placed = true;
      if (this.following) {
        this.map.jumpTo({ center, zoom: Math.max(this.map.getZoom(), STREET_ZOOM) });
      }
    } else if (this.following && !this.map.isZooming() && !this.map.isRotating()) {
      this.glideTo(center);
    }
  }

  private glideTo(center: [number, number]): void {
    if (this.still.matches || document.hidden) {
      this.map.jumpTo({ center });
    } else {
      this.map.easeTo({ center, duration: GLIDE_MS, easing: (share) => share });
    }
  }

  private overviewUnplaced(): void {
    if (!this.placed) {
      this.fitAll(false);
    }
  }

  private fitAll(animate: boolean): void {
    const bounds = new LngLatBounds();
    for (const route of this.routes) {
      for (const { geometry } of route.features) {
        extend(bounds, geometry);
      }
    }
    for (const vehicle of this.fleet?.vehicles.values() ?? []) {
      const center = position(vehicle);
      if (center !== null) {
        bounds.extend(center);
      }
    }
    for (const point of this.vehicle()?.trail ?? []) {
      bounds.extend([point.lon_deg, point.lat_deg]);
    }
    if (!bounds.isEmpty()) {
      const glides = animate && !this.still.matches;
      // the legend and the buttons lie over the right edge
      const right = this.map.getContainer().clientWidth > 700 ? 200 : 70;
      const padding = { top: 70, bottom: 50, left: 50, right };
      this.map.fitBounds(bounds, { padding, maxZoom: 17, animate: glides });
    }
  }
}

function extend(bounds: LngLatBounds, geometry: GeoJSON.Geometry): void {
  if (geometry.type === "Point") {
    bounds.extend(geometry.coordinates as [number, number]);
  } else if (geometry.type === "LineString") {
    for (const point of geometry.coordinates) {
      bounds.extend(point as [number, number]);
    }
  }
}
