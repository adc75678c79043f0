//! The quantities that controllers give and take, with their types, as the manufacturer's guide and the
//! recipe file of its client list them.

use super::Type;

/// Name and type of a quantity.
pub type Field = (&'static str, Type);

use Type::{Bool, Double, Int32, Uint8, Uint32, Uint64, Vector3d, Vector6Int32, Vector6d};

/// From controller to client; registers are beside them.
pub const OUTPUTS: &[Field] = &[
    ("timestamp", Double),
    ("target_q", Vector6d),
    ("target_qd", Vector6d),
    ("target_qdd", Vector6d),
    ("target_current", Vector6d),
    ("target_moment", Vector6d),
    ("actual_q", Vector6d),
    ("actual_qd", Vector6d),
    ("actual_qdd", Vector6d),
    ("actual_current", Vector6d),
    ("actual_current_window", Vector6d),
    ("actual_current_as_torque", Vector6d),
    ("joint_control_output", Vector6d),
    ("actual_TCP_pose", Vector6d),
    ("actual_TCP_speed", Vector6d),
    ("actual_TCP_force", Vector6d),
    ("target_TCP_pose", Vector6d),
    ("target_TCP_speed", Vector6d),
    ("actual_digital_input_bits", Uint64),
    ("actual_configurable_digital_input_bits", Uint64),
    ("joint_temperatures", Vector6d),
    ("actual_execution_time", Double),
    ("robot_mode", Int32),
    ("joint_mode", Vector6Int32),
    ("safety_mode", Int32),
    ("safety_status", Int32),
    ("actual_tool_accelerometer", Vector3d),
    ("speed_scaling", Double),
    ("target_speed_fraction", Double),
    ("actual_momentum", Double),
    ("actual_main_voltage", Double),
    ("actual_robot_voltage", Double),
    ("actual_robot_current", Double),
    ("actual_joint_voltage", Vector6d),
    ("actual_digital_output_bits", Uint64),
    ("actual_configurable_digital_output_bits", Uint64),
    ("runtime_state", Uint32),
    ("elbow_position", Vector3d),
    ("elbow_velocity", Vector3d),
    ("robot_status_bits", Uint32),
    ("safety_status_bits", Uint32),
    ("analog_io_types", Uint32),
    ("standard_analog_input0", Double),
    ("standard_analog_input1", Double),
    ("standard_analog_output0", Double),
    ("standard_analog_output1", Double),
    ("io_current", Double),
    ("euromap67_input_bits", Uint32),
    ("euromap67_output_bits", Uint32),
    ("euromap67_24V_voltage", Double),
    ("euromap67_24V_current", Double),
    ("tool_mode", Uint32),
    ("tool_analog_input_types", Uint32),
    ("tool_analog_input0", Double),
    ("tool_analog_input1", Double),
    ("tool_output_voltage", Int32),
    ("tool_output_current", Double),
    ("tool_temperature", Double),
    ("tool_output_mode", Uint8),
    ("tool_digital_output0_mode", Uint8),
    ("tool_digital_output1_mode", Uint8),
    ("tcp_force_scalar", Double),
    ("tcp_offset", Vector6d),
    ("payload", Double),
    ("payload_cog", Vector3d),
    ("payload_inertia", Vector6d),
    ("ft_raw_wrench", Vector6d),
    ("joint_position_deviation_ratio", Double),
    ("script_control_line", Uint32),
    ("encoder0_raw", Int32),
    ("encoder1_raw", Int32),
    ("output_bit_registers0_to_31", Uint32),
    ("output_bit_registers32_to_63", Uint32),
    ("input_bit_registers0_to_31", Uint32),
    ("input_bit_registers32_to_63", Uint32),
];

/// From client to controller; registers are beside them.
pub const INPUTS: &[Field] = &[
    ("speed_slider_mask", Uint32),
    ("speed_slider_fraction", Double),
    ("standard_digital_output_mask", Uint8),
    ("configurable_digital_output_mask", Uint8),
    ("standard_digital_output", Uint8),
    ("configurable_digital_output", Uint8),
    ("standard_analog_output_mask", Uint8),
    ("standard_analog_output_type", Uint8),
    ("standard_analog_output_0", Double),
    ("standard_analog_output_1", Double),
    ("tool_digital_output_mask", Uint8),
    ("tool_digital_output", Uint8),
    ("external_force_torque", Vector6d),
    ("input_bit_registers0_to_31", Uint32),
    ("input_bit_registers32_to_63", Uint32),
];

/// Registers are numbered: `output_double_register_0`, ..; how many there are, and from which on.
const REGISTERS: [(&str, Type, std::ops::Range<usize>); 3] =
    [("int", Int32, 0..48), ("double", Double, 0..48), ("bit", Bool, 64..128)];

/// Type of a register, `side` being `input` or `output`.
fn register(side: &str, name: &str) -> Option<Type> {
    let rest = name.strip_prefix(side)?.strip_prefix('_')?;
    let (kind, number) = rest.split_once("_register_")?;
    let canonical = number.len() == 1 || !number.starts_with('0');
    let number: usize = number.parse().ok().filter(|_| canonical)?;
    REGISTERS.iter().find(|(k, _, range)| *k == kind && range.contains(&number)).map(|(_, t, _)| *t)
}

/// Type of a quantity that a controller gives.
pub fn type_of(name: &str) -> Option<Type> {
    let listed = OUTPUTS.iter().find(|(n, _)| *n == name).map(|(_, t)| *t);
    listed.or_else(|| register("output", name)).or_else(|| register("input", name))
}

/// Type of a quantity that a controller takes.
pub fn input_type(name: &str) -> Option<Type> {
    let listed = INPUTS.iter().find(|(n, _)| *n == name).map(|(_, t)| *t);
    listed.or_else(|| register("input", name))
}

/// Whether some controller gives it.
pub fn is_known(name: &str) -> bool {
    type_of(name).is_some()
}
