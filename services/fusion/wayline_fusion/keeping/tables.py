"""Pure: the table of the fusion database, one row a vehicle."""

import sqlalchemy as sa

METADATA = sa.MetaData()

VEHICLES = sa.Table(
    "fusion_vehicle",
    METADATA,
    sa.Column("vehicle_id", sa.Text, primary_key=True),
    # Unix time of the measurement that the row describes
    sa.Column("t_ns", sa.BigInteger, nullable=False),
    sa.Column("gyro_bias_degps", sa.Float, nullable=False),
    sa.Column("gyro_bias_std_degps", sa.Float, nullable=False),
    sa.Column("gyro_scale", sa.Float, nullable=False),
    sa.Column("gyro_scale_std", sa.Float, nullable=False),
    sa.Column("odometer_scale", sa.Float, nullable=False),
    sa.Column("odometer_scale_std", sa.Float, nullable=False),
    sa.Column("gps_latency_s", sa.Float, nullable=False),
    sa.Column("gps_latency_std_s", sa.Float, nullable=False),
    # JSON list: upper triangle of the correlations of the four above, row by row
    sa.Column("correlations", sa.Text, nullable=False),
    sa.Column("gyro_temperature_c", sa.Float),
    sa.Column("position_noise_factor", sa.Float, nullable=False),
    sa.Column("velocity_noise_factor", sa.Float, nullable=False),
    sa.Column("bias_wander_factor", sa.Float, nullable=False),
    sa.Column("pressure_noise_factor", sa.Float, nullable=False, server_default="1.0"),
    sa.Column("torque_noise_factor", sa.Float, nullable=False, server_default="1.0"),
    sa.Column("vehicle_slope_noise_factor", sa.Float, nullable=False, server_default="1.0"),
    # the pose; all null where position or heading were not known
    sa.Column("lat_deg", sa.Float),
    sa.Column("lon_deg", sa.Float),
    sa.Column("east_std_m", sa.Float),
    sa.Column("north_std_m", sa.Float),
    sa.Column("heading_deg", sa.Float),
    sa.Column("heading_std_deg", sa.Float),
    sa.Column("speed_mps", sa.Float),
    sa.Column("fix_ns", sa.BigInteger),
    # altitude, slope and barometer; all null where no altitude was known
    sa.Column("alt_m", sa.Float),
    sa.Column("alt_std_m", sa.Float),
    sa.Column("grade_pct", sa.Float),
    sa.Column("grade_std_pct", sa.Float),
    sa.Column("baro_bias_m", sa.Float),
    sa.Column("baro_bias_std_m", sa.Float),
    sa.Column("alt_bias_correlation", sa.Float),
    sa.Column("inverse_mass", sa.Float),
    sa.Column("inverse_mass_std", sa.Float),
)
